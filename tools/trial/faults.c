/* Counts writes to regular files; at one of them the process is killed, or it and all later ones fail. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static long count, at;
static int error;

/* After `nth` writes: the error, or SIGKILL if it is negative; nothing while nth is zero. */
void trial_arm(long nth, int how) { count = 0, at = nth, error = how; }
long trial_count(void) { return count; }

static int fails(int file) {
    struct stat of;
    if (file <= 2 || fstat(file, &of) != 0 || !S_ISREG(of.st_mode)) return 0;
    if (++count < at || at == 0) return 0;
    if (error < 0) kill(getpid(), SIGKILL);
    errno = error;
    return 1;
}

#define NEXT(type, name) static type (*next) name; if (!next) next = dlsym(RTLD_NEXT, __func__)

ssize_t write(int f, const void *b, size_t n) {
    NEXT(ssize_t, (int, const void *, size_t));
    return fails(f) ? -1 : next(f, b, n);
}
ssize_t pwrite(int f, const void *b, size_t n, off_t o) {
    NEXT(ssize_t, (int, const void *, size_t, off_t));
    return fails(f) ? -1 : next(f, b, n, o);
}
ssize_t pwrite64(int f, const void *b, size_t n, off64_t o) {
    NEXT(ssize_t, (int, const void *, size_t, off64_t));
    return fails(f) ? -1 : next(f, b, n, o);
}
ssize_t writev(int f, const struct iovec *v, int n) {
    NEXT(ssize_t, (int, const struct iovec *, int));
    return fails(f) ? -1 : next(f, v, n);
}
int fsync(int f) {
    NEXT(int, (int));
    return fails(f) ? -1 : next(f);
}
