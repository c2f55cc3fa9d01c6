/* test.h - the smallest test harness: TEST functions, CHECK in them, RUN in main, test_done() last.
 * Each test program ends with the line "N passed, N failed" (", N skipped" where a test could not run on this
 * machine); tests/run.sh adds them up. A CHECK outside of a test that RUN calls counts for nothing.
 * With LC_TEST_STOP in the environment the program ends with the first CHECK that fails. */
#ifndef TEST_H
#define TEST_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 1 in a build with that sanitizer, or for an emulator (TEST_SLOWLY, tests/arm64.sh): both slow programs
 * tenfold and more, and TSan looks at threads only: tests that repeat something on one thread repeat it less
 * often. */
#if defined(__SANITIZE_THREAD__) || defined(TEST_SLOWLY)
#define UNDER_TSAN 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define UNDER_TSAN 1
#endif
#endif
#ifndef UNDER_TSAN
#define UNDER_TSAN 0
#endif
#if defined(__has_feature)
#if __has_feature(memory_sanitizer)
#define UNDER_MSAN 1
#endif
#endif
#ifndef UNDER_MSAN
#define UNDER_MSAN 0
#endif
#if defined(__SANITIZE_ADDRESS__)
#define UNDER_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNDER_ASAN 1
#endif
#endif
#ifndef UNDER_ASAN
#define UNDER_ASAN 0
#endif

static int test_passed, test_failed, test_skipped;
static int test_bad __attribute__((unused));    /* checks of the running test that failed */
static int test_absent __attribute__((unused)); /* 1: what the running test needs is absent */

#define TEST(name) static void name(void)

static inline void test_stop(void)
{
    if (getenv("LC_TEST_STOP")) {
        printf("0 passed, 1 failed\n");
        exit(1);
    }
}

#define CHECK(cond)                                                                                          \
    do {                                                                                                     \
        if (!(cond)) {                                                                                       \
            test_bad++;                                                                                      \
            if (test_bad <= 10) printf("  %s:%d: %s\n", __FILE__, __LINE__, #cond);                          \
            test_stop();                                                                                     \
        }                                                                                                    \
    } while (0)

/* CHECK that prints figures when it fails. */
#define CHECKF(cond, ...)                                                                                    \
    do {                                                                                                     \
        if (!(cond)) {                                                                                       \
            test_bad++;                                                                                      \
            if (test_bad <= 10)                                                                              \
                printf("  %s:%d: %s: ", __FILE__, __LINE__, #cond), printf(__VA_ARGS__), printf("\n");       \
            test_stop();                                                                                     \
        }                                                                                                    \
    } while (0)

/* Ends a test that cannot run on this machine, with the reason: it counts as skipped, or as failed if a check
 * failed before. */
#define SKIP(...)                                                                                            \
    do {                                                                                                     \
        test_absent = 1;                                                                                     \
        printf("  skipped: "), printf(__VA_ARGS__), printf("\n");                                            \
        return;                                                                                              \
    } while (0)

#define RUN(name)                                                                                            \
    do {                                                                                                     \
        test_bad = test_absent = 0;                                                                          \
        name();                                                                                              \
        if (test_bad) test_failed++;                                                                         \
        else if (test_absent) test_skipped++;                                                                \
        else test_passed++;                                                                                  \
        printf("%s %s\n", test_bad ? "FAIL" : test_absent ? "skip" : "ok  ", #name);                         \
        fflush(stdout);                                                                                      \
    } while (0)

static inline int test_done(void)
{
    printf("%d passed, %d failed", test_passed, test_failed);
    if (test_skipped) printf(", %d skipped", test_skipped);
    printf("\n");
    return test_failed != 0;
}

#endif
