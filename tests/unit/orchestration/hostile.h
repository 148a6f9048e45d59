/* What a hostile or careless library does to its host in a step, by the name of the fault. */
#include <arpa/inet.h>
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

static const char forged[] = "{\"finding\": [\"1\", \"error\", \"forged\"]}\n{\"done\": true}\n";

static void *sleeper(void *unused) { return sleep(3600), unused; }

static void write_file(const char *path) {
    FILE *file = fopen(path, "w");
    if (file) fputs("written by the FMU\n", file), fclose(file);
}

static void write_everywhere(void) {
    char path[4096];
    write_file("left.txt");
    write_file("../results"), write_file("../trace"), write_file("../printed"), write_file("../plan.json");
    snprintf(path, sizeof path, "/tmp/adaptimp-escaped-%d", (int)getppid());
    write_file(path);
    if (getenv("HOME")) snprintf(path, sizeof path, "%s/home.txt", getenv("HOME")), write_file(path);
}

static void fork_and_outlive(void) {
    if (fork() != 0) return;
    setsid();
    sleep(3600);
    _exit(0);
}

static void harm(const char *fault) {
    static int done;
    if (done++) return;
#define KIND(name) if (strcmp(fault, name) == 0)
    KIND("writes") write_everywhere();
    KIND("forks") fork_and_outlive();
    KIND("kills") kill(getppid(), SIGKILL), kill(-1, SIGKILL), syscall(SYS_tgkill, getppid(), getppid(), SIGKILL);
    KIND("owns") fcntl(0, F_SETOWN, getppid()), fcntl(0, F_SETSIG, SIGKILL);
    KIND("outlives") prctl(PR_SET_PDEATHSIG, 0);
    KIND("prints") fputs(forged, stdout), fflush(stdout);
    KIND("forges") for (int fd = 0; fd < 256; fd++) (void)!write(fd, forged, sizeof forged - 1);
    KIND("eats") {
        static char *volatile eaten;
        for (int i = 0; i < 1000; i++) {
            eaten = malloc((size_t)1 << 28);
            if (eaten == NULL) abort();
            memset(eaten, 1, 4096);
        }
    }
    KIND("opens") for (int i = 0; i < 5000; i++) if (open("/dev/null", O_RDONLY) < 0) abort();
    KIND("threads") {
        pthread_t thread;
        for (int i = 0; i < 100000; i++) if (pthread_create(&thread, NULL, sleeper, NULL)) abort();
    }
    KIND("runs") (void)!system("touch /tmp/adaptimp-escaped");
    KIND("becomes") execl("/bin/sleep", "sleep", "3600", (char *)NULL);
    KIND("connects") {
        struct sockaddr_in there = {.sin_family = AF_INET, .sin_port = htons(9)};
        inet_pton(AF_INET, "127.0.0.1", &there.sin_addr);
        int s = socket(AF_INET, SOCK_STREAM, 0);
        if (s >= 0) (void)!connect(s, (struct sockaddr *)&there, sizeof there);
    }
    KIND("leaves") exit(0);
    KIND("closes") for (int fd = 0; fd < 256; fd++) close(fd);
    KIND("stops") raise(SIGSTOP);
    KIND("rounds") fesetround(FE_UPWARD);
#if defined(__x86_64__)
    KIND("flushes") _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
    KIND("locale") setlocale(LC_ALL, "C.UTF-8"), setlocale(LC_ALL, "POSIX"), setlocale(LC_NUMERIC, "C.utf8");
    KIND("moves") (void)!chdir("/");
    KIND("signals") signal(SIGINT, SIG_IGN);
}

static void harm_inputs(const char *fault, const fmi2ValueReference vr[], const fmi2Real value[]) {
    KIND("overwrites") *(fmi2Real *)value = 42;
    KIND("renumbers") *(fmi2ValueReference *)vr = 7;
}

#ifdef ON_LOADING
__attribute__((constructor)) static void when_loaded(void) { fesetround(FE_DOWNWARD); }
#endif
