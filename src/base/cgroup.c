/* cgroup.c - what this process's control groups leave it: processors, by the CPU quota, and memory.
 *
 *                  line of /proc/self/cgroup    files in each folder from /a/b up to the root
 *     version 2    0::/a/b                      cpu.max: "QUOTA PERIOD" or "max PERIOD"
 *                                               memory.max: bytes or "max"; memory.current; memory.stat
 *     version 1    3:cpu,cpuacct:/a/b           cpu.cfs_quota_us (-1: none) and cpu.cfs_period_us
 *                  4:memory:/a/b                memory.limit_in_bytes, .usage_in_bytes, .stat
 */
#include "base/cpu.h"
#include "base/memory.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROOT "/sys/fs/cgroup"
#define NO_LIMIT ((uint64_t)1 << 60)   /* bytes; version 1 has a number near 2^63 for none */
#define LEAST_LEFT ((uint64_t)64 << 20) /* bytes; where less is left the kernel finds some, or says so */

/* Reads the beginning of a file as text; false if it is empty or cannot be read. */
static bool read_text(const char *path, char *text, size_t size)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    ssize_t n = fd < 0 ? -1 : read(fd, text, size - 1);
    if (fd >= 0) close(fd);
    text[n > 0 ? n : 0] = 0;
    return n > 0;
}

/* The processors that a quota of time per period amounts to, rounded up; 0: no limit. */
static uint32_t whole(long long quota, long long period)
{
    if (quota <= 0 || period <= 0 || quota > (long long)LC_MAX_THREADS * period) return 0;
    return (uint32_t)((quota + period - 1) / period);
}

static uint64_t quota_of_folder(const char *folder, bool v2)
{
    char path[1200], text[64];
    char *end;
    snprintf(path, sizeof path, "%s/%s", folder, v2 ? "cpu.max" : "cpu.cfs_quota_us");
    if (!read_text(path, text, sizeof text)) return 0;
    long long quota = strtoll(text, &end, 10);
    if (end == text) return 0;
    if (v2) return whole(quota, strtoll(end, NULL, 10));
    snprintf(path, sizeof path, "%s/cpu.cfs_period_us", folder);
    return read_text(path, text, sizeof text) ? whole(quota, strtoll(text, NULL, 10)) : 0;
}

/* Of a group's folder; 0: no limit. */
typedef uint64_t limit_of(const char *folder, bool v2);

/* The smaller limit, where 0 is none. */
static uint64_t least(uint64_t a, uint64_t b) { return !a || (b && b < a) ? b : a; }

/* The smallest limit of a group and all groups above it. Groups whose folder is not visible, as in a
 * container, are skipped. */
static uint64_t least_of_group(const char *root, const char *controller, char *group, bool v2,
                               limit_of *limit)
{
    char folder[1100];
    uint64_t n = 0;
    for (;;) {
        snprintf(folder, sizeof folder, "%s" ROOT "/%s%s", root, controller, group);
        n = least(n, limit(folder, v2));
        char *slash = strrchr(group, '/');
        if (!slash) return n;
        *slash = 0;
    }
}

static bool has_name(const char *controllers, const char *name)
{
    for (const char *p = controllers; *p; p += *p == ',') {
        size_t len = strcspn(p, ",");
        if (len == strlen(name) && !strncmp(p, name, len)) return true;
        p += len;
    }
    return false;
}

/* The smallest limit of all groups of this process; controller: its name in version 1. */
static uint64_t least_of_all(const char *root, const char *controller, limit_of *limit)
{
    char path[512], text[4096], *rest = text;
    uint64_t n = 0;
    snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
    if (!read_text(path, text, sizeof text)) return 0;
    for (char *line; (line = strsep(&rest, "\n"));) { /* number:controllers:group */
        char *controllers = strchr(line, ':'), *group = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!group || strlen(group) > 512) continue;
        *group++ = 0;
        controllers++;
        if (!*controllers) n = least(n, least_of_group(root, "", group, true, limit));
        else if (has_name(controllers, controller))
            n = least(n, least_of_group(root, controllers, group, false, limit));
    }
    return n;
}

uint32_t lc_cpu_quota(const char *root) { return (uint32_t)least_of_all(root, "cpu", quota_of_folder); }

/* ---- memory ---- */

/* The number after a word at the start of a line, or of the text if there is no word; 0: there is none. */
static uint64_t number_of(const char *text, const char *word)
{
    const size_t len = strlen(word);
    for (const char *line = text; line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
        if (!strncmp(line, word, len)) return strtoull(line + len, NULL, 10);
    return 0;
}

static uint64_t number_in(const char *folder, const char *file, const char *word)
{
    char path[1200], text[8192];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return read_text(path, text, sizeof text) ? number_of(text, word) : 0;
}

/* What a group leaves: its limit less what it uses, but for pages of files, which the kernel takes back. */
static uint64_t left_of_folder(const char *folder, bool v2)
{
    uint64_t max = number_in(folder, v2 ? "memory.max" : "memory.limit_in_bytes", "");
    if (!max || max >= NO_LIMIT) return 0;
    uint64_t used = number_in(folder, v2 ? "memory.current" : "memory.usage_in_bytes", "");
    uint64_t pages = number_in(folder, "memory.stat", v2 ? "inactive_file " : "total_inactive_file ");
    used = used > pages ? used - pages : 0;
    return max > used + LEAST_LEFT ? max - used : LEAST_LEFT;
}

uint64_t lc_memory_left_below(const char *root)
{
    char folder[512];
    snprintf(folder, sizeof folder, "%s/proc", root);
    uint64_t machine = number_in(folder, "meminfo", "MemAvailable:") * 1024;
    uint64_t left = least(machine, least_of_all(root, "memory", left_of_folder));
    return left ? left : UINT64_MAX;
}
