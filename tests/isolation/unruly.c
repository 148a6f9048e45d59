/* A small FMU that does what its GUID says after the dash: a place, a blank, and a deed, such as "step crash".
   Output 1 is the time; a deed in a step is done in the step that ends after 0.5 s. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <fenv.h>
#include <limits.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "fmi2Functions.h"
#undef fmi2DoStep
#undef fmi2Instantiate
#undef fmi2Terminate
#undef fmi2SetReal
#undef fmi2GetReal
#define fmi2DoStep calm_step
#define fmi2Instantiate calm_instantiate
#define fmi2Terminate calm_terminate
#define fmi2SetReal calm_set_real
#define fmi2GetReal calm_get_real
#include "../strangers/stranger.c"
#undef fmi2DoStep
#undef fmi2Instantiate
#undef fmi2Terminate
#undef fmi2SetReal
#undef fmi2GetReal

static void on_signal(int number) { UNUSED(number); }

static char *volatile block;

static void eat(void) {
    for (size_t k = 0; k < 100000; k++) {
        block = malloc(1 << 20);
        if (block == NULL) abort();
        memset(block, 1, 1 << 20);
    }
}

/* Returns whether the call goes on as usual. */
static int done(const char *deed) {
    volatile int *nowhere = NULL;
    if (!strcmp(deed, "refuse") || !strcmp(deed, "minus one")) return 0;
    if (!strcmp(deed, "lowest") || !strcmp(deed, "hundred")) return 0;
    if (!strcmp(deed, "crash")) *nowhere = 1;
    if (!strcmp(deed, "hang"))
        for (volatile int on = 1; on;) { }
    if (!strcmp(deed, "sleep")) usleep(300000);
    if (!strcmp(deed, "exit")) exit(0);
    if (!strcmp(deed, "end")) _exit(0);
    if (!strcmp(deed, "abort")) abort();
    if (!strcmp(deed, "memory")) eat();
    if (!strcmp(deed, "files"))
        for (int k = 0; k < 5000; k++)
            if (open("/dev/null", O_RDONLY) < 0) return 0;
    if (!strcmp(deed, "close"))
        for (int k = 3; k < 256; k++) close(k);
    if (!strcmp(deed, "folder") && chdir("/")) return 0;
    if (!strcmp(deed, "locale")) setlocale(LC_ALL, "C.UTF-8"), setlocale(LC_NUMERIC, "C"), setlocale(LC_COLLATE, "C");
    if (!strcmp(deed, "rounding")) fesetround(FE_UPWARD);
#if defined(__x86_64__)
    if (!strcmp(deed, "flush")) _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
    if (!strcmp(deed, "signals")) signal(SIGINT, on_signal), signal(SIGTERM, SIG_IGN);
    if (!strcmp(deed, "print")) puts("{\"forged\": true}"), fflush(stdout);
    return 1;
}

static int deed_at(const Model *m, const char *place) {
    const size_t n = strlen(place);
    return strncmp(m->kind, place, n) || m->kind[n] != ' ' ? 1 : done(m->kind + n + 1);
}

/* The status of a call that is refused; FMI defines those from 0 to 5. */
static fmi2Status refused(const Model *m) {
    if (strstr(m->kind, " minus one")) return (fmi2Status)-1;
    if (strstr(m->kind, " hundred")) return (fmi2Status)100;
    return strstr(m->kind, " lowest") ? (fmi2Status)INT_MIN : fmi2Error;
}

#ifdef AT_LOADING
__attribute__((constructor)) static void at_loading(void) { done(AT_LOADING); }
#endif

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    Model *m = calm_instantiate(name, type, guid, location, callbacks, visible, logging);
    return deed_at(m, "instantiate") ? m : NULL;
}
FMI2_Export fmi2Status fmi2Terminate(fmi2Component c) { return deed_at(c, "terminate") ? fmi2OK : refused(c); }
FMI2_Export fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    return deed_at(c, "set") ? calm_set_real(c, vr, n, value) : refused(c);
}
FMI2_Export fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    return deed_at(c, "get") ? calm_get_real(c, vr, n, value) : refused(c);
}
FMI2_Export fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean keep) {
    Model *m = c;
    UNUSED(keep);
    if (t + h > 0.5 + 1e-9 && t < 0.5 + 1e-9 && !deed_at(m, "step"))
        return say(m, fmi2Error, "this cannot be done", t), refused(m);
    if (!strcmp(m->kind, "step talk")) say(m, fmi2OK, "all is well", t);
    m->real[1] = t + h;
    return fmi2OK;
}
