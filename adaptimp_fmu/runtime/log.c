/* Messages to the host's logger. The runtime formats them, so that the logger gets finished text. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "instance.h"

#define MESSAGE_LENGTH 512

typedef struct {
    const char *name;
    int mask;
} LogCategory;

static const LogCategory log_categories[] = {
    {"logStatusError", LOG_ERROR},
    {"logStatusWarning", LOG_WARNING},
    {"logAll", LOG_ALL},
};
#define N_LOG_CATEGORIES (sizeof log_categories / sizeof log_categories[0])

/* The logger's message is a printf format: a percent sign in the text is doubled. */
static void escape_percent(const char *text, char *escaped, size_t size) {
    size_t n = 0;
    for (; *text && n + 2 < size; ++text) {
        if (*text == '%') escaped[n++] = '%';
        escaped[n++] = *text;
    }
    escaped[n] = '\0';
}

static void send_message(const fmi2CallbackFunctions *callbacks, const char *name,
                         fmi2Status status, const char *category, const char *format,
                         va_list arguments) {
    char text[MESSAGE_LENGTH], escaped[2 * MESSAGE_LENGTH];
    if (!callbacks || !callbacks->logger) return;
    vsnprintf(text, sizeof text, format, arguments);
    escape_percent(text, escaped, sizeof escaped);
    callbacks->logger(callbacks->componentEnvironment, name ? name : "", status, category, escaped);
}

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
/* Logs an error if errors are logged, and returns fmi2Error. */
static fmi2Status fail(const Instance *instance, const char *format, ...) {
    if (instance->logged & LOG_ERROR) {
        va_list arguments;
        va_start(arguments, format);
        send_message(&instance->callbacks, instance->name, fmi2Error, "logStatusError", format,
                     arguments);
        va_end(arguments);
    }
    return fmi2Error;
}

#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
/* Logs why an instance cannot be created, and returns NULL. */
static fmi2Component refuse(const fmi2CallbackFunctions *callbacks, const char *name, int logging,
                            const char *format, ...) {
    if (logging) {
        va_list arguments;
        va_start(arguments, format);
        send_message(callbacks, name, fmi2Error, "logStatusError", format, arguments);
        va_end(arguments);
    }
    return NULL;
}

/* The mask of a category's name, 0 if there is no such category. */
static int category_mask(const char *name) {
    for (size_t i = 0; name && i < N_LOG_CATEGORIES; ++i)
        if (strcmp(name, log_categories[i].name) == 0) return log_categories[i].mask;
    return 0;
}
