/* Stands in for HAL, so that a kinematics module of LinuxCNC can be loaded into any process: a pin is a double by name. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PINS 64
static struct {
    char name[64];
    double value;
} pins[PINS];
static int count;

/* Sets a pin; 0 when there is one of that name. */
int set_pin(const char *name, double value)
{
    for (int i = 0; i < count; i++) {
        if (strcmp(pins[i].name, name) == 0) {
            pins[i].value = value;
            return 0;
        }
    }
    return -1;
}

int hal_pin_float_newf(int direction, double **at, int component, const char *format, ...)
{
    (void)direction, (void)component;
    if (count == PINS) return -1;
    va_list values;
    va_start(values, format);
    vsnprintf(pins[count].name, sizeof pins[count].name, format, values);
    va_end(values);
    *at = &pins[count++].value;
    return 0;
}

/* Pins of other kinds exist, and nobody sets them. */
static int other(void **at)
{
    *at = calloc(1, 16);
    return *at ? 0 : -1;
}
int hal_pin_bit_new(const char *n, int d, void **at, int c) { (void)n, (void)d, (void)c; return other(at); }
int hal_pin_s32_new(const char *n, int d, void **at, int c) { (void)n, (void)d, (void)c; return other(at); }
int hal_pin_u32_new(const char *n, int d, void **at, int c) { (void)n, (void)d, (void)c; return other(at); }
int hal_pin_bit_newf(int d, void **at, int c, const char *f, ...) { (void)d, (void)c, (void)f; return other(at); }
int hal_pin_s32_newf(int d, void **at, int c, const char *f, ...) { (void)d, (void)c, (void)f; return other(at); }

int hal_init(const char *name) { (void)name; return 1; }
int hal_ready(int component) { (void)component; return 0; }
int hal_exit(int component) { (void)component; return 0; }
void *hal_malloc(long size) { return calloc(1, (size_t)size); }
void rtapi_print(const char *format, ...) { (void)format; }
void rtapi_print_msg(int level, const char *format, ...) { (void)level, (void)format; }
