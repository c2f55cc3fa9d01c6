/* test.h - the smallest test harness: TEST functions, CHECK in them, RUN in main, test_done() last.
 * Each test program ends with the line "N passed, N failed"; tests/run.sh adds them up. */
#ifndef TEST_H
#define TEST_H

#include <stdio.h>
#include <string.h>

/* TSan slows programs tenfold and looks at threads only: what repeats without them is done less often. */
#if defined(__SANITIZE_THREAD__)
#define UNDER_TSAN 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define UNDER_TSAN 1
#endif
#endif
#ifndef UNDER_TSAN
#define UNDER_TSAN 0
#endif

static int test_passed, test_failed, test_bad;

#define TEST(name) static void name(void)

#define CHECK(cond)                                                                                                   \
    do {                                                                                                              \
        if (!(cond)) {                                                                                                \
            test_bad++;                                                                                               \
            if (test_bad <= 10) printf("  %s:%d: %s\n", __FILE__, __LINE__, #cond);                                   \
        }                                                                                                             \
    } while (0)

/* CHECK with figures */
#define CHECKF(cond, ...)                                                                                             \
    do {                                                                                                              \
        if (!(cond)) {                                                                                                \
            test_bad++;                                                                                               \
            if (test_bad <= 10) printf("  %s:%d: %s: ", __FILE__, __LINE__, #cond), printf(__VA_ARGS__), printf("\n"); \
        }                                                                                                             \
    } while (0)

#define RUN(name)                                                                                                     \
    do {                                                                                                              \
        test_bad = 0;                                                                                                 \
        name();                                                                                                       \
        if (test_bad) test_failed++; else test_passed++;                                                              \
        printf("%s %s\n", test_bad ? "FAIL" : "ok  ", #name);                                                         \
        fflush(stdout);                                                                                               \
    } while (0)

static inline int test_done(void)
{
    printf("%d passed, %d failed\n", test_passed, test_failed);
    return test_failed != 0;
}

#endif
