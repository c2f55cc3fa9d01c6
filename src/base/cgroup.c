/* cgroup.c - the CPU quota of this process's control groups, as a number of processors.
 *
 *                  line of /proc/self/cgroup    files in each folder from /a/b up to the root
 *     version 2    0::/a/b                      cpu.max: "QUOTA PERIOD" or "max PERIOD"
 *     version 1    3:cpu,cpuacct:/a/b           cpu.cfs_quota_us (-1: none) and cpu.cfs_period_us
 */
#include "base/cpu.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROOT "/sys/fs/cgroup"

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

static uint32_t quota_of_folder(const char *folder, bool v2)
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

/* The smaller limit, where 0 is none. */
static uint32_t least(uint32_t a, uint32_t b) { return !a || (b && b < a) ? b : a; }

/* The smallest quota of a group and all groups above it. Groups whose folder is not visible, as in a
 * container, are skipped. */
static uint32_t quota_of_group(const char *root, const char *controller, char *group, bool v2)
{
    char folder[1100];
    uint32_t n = 0;
    for (;;) {
        snprintf(folder, sizeof folder, "%s" ROOT "/%s%s", root, controller, group);
        n = least(n, quota_of_folder(folder, v2));
        char *slash = strrchr(group, '/');
        if (!slash) return n;
        *slash = 0;
    }
}

static bool names_cpu(const char *controllers)
{
    for (const char *p = controllers; *p; p += *p == ',') {
        size_t len = strcspn(p, ",");
        if (len == 3 && !strncmp(p, "cpu", 3)) return true;
        p += len;
    }
    return false;
}

uint32_t lc_cpu_quota(const char *root)
{
    char path[512], text[4096], *rest = text;
    uint32_t n = 0;
    snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
    if (!read_text(path, text, sizeof text)) return 0;
    for (char *line; (line = strsep(&rest, "\n"));) { /* number:controllers:group */
        char *controllers = strchr(line, ':'), *group = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!group || strlen(group) > 512) continue;
        *group++ = 0;
        controllers++;
        if (!*controllers) n = least(n, quota_of_group(root, "", group, true));
        else if (names_cpu(controllers)) n = least(n, quota_of_group(root, controllers, group, false));
    }
    return n;
}
