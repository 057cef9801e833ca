/*
 * The frames of one control cycle, and the program around `receive`, which adds the numbers of a frame to a sum of type
 * VALUE. `motor_t` and `motor_of` describe the motor. Freestanding, there is no program.
 */
#include <stdint.h>
#if __STDC_HOSTED__
#include <stdio.h>
#include <string.h>
#endif

#define FRAMES 12u
#define CYCLES 1000u

#if __STDC_HOSTED__
/* The frames of one control cycle of an MG motor. */
static const struct {
    uint32_t id;
    uint8_t data[8];
} CYCLE[FRAMES] = {
    {0x141u, {0xA1, 0x32, 0x9B, 0x00, 0xF4, 0x01, 0x00, 0x80}},
    {0x142u, {0x92, 0xB0, 0x3C, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}},
    {0x143u, {0x9A, 0x32, 0x00, 0xE7, 0x01, 0x00, 0x00, 0x08}},
    {0x141u, {0x9C, 0x1E, 0x65, 0xFF, 0x0C, 0xFE, 0x34, 0x12}},
    {0x144u, {0xA4, 0x21, 0x10, 0x02, 0xC8, 0x00, 0xFF, 0xFF}},
    {0x141u, {0x94, 0x00, 0x00, 0x00, 0x50, 0x46, 0x00, 0x00}},
    {0x142u, {0x90, 0x00, 0x10, 0x20, 0x00, 0x30, 0x00, 0x10}},
    {0x143u, {0x9D, 0x28, 0x40, 0x00, 0xC0, 0xFF, 0x80, 0x01}},
    {0x145u, {0x88, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00}},
    {0x141u, {0x30, 0x00, 0x64, 0x32, 0x28, 0x0E, 0x1E, 0x1E}},
    {0x142u, {0xA2, 0x2C, 0xCE, 0xFF, 0x18, 0xFC, 0x00, 0x40}},
    {0x141u, {0x33, 0x00, 0x00, 0x00, 0x10, 0x27, 0x00, 0x00}},
};
#endif

__attribute__((noinline)) int receive_cycle(VALUE *sum, const canwright_frame_t *frames, const motor_t *motor)
{
    int failures = 0;
    unsigned i;
    for (i = 0u; i < FRAMES; i++) {
        failures += receive(sum, &frames[i], motor) != 0;
    }
    return failures;
}

#if __STDC_HOSTED__
/* Prints the number of cycles. The motor depends on the arguments, so that a compiler does not know it. */
int main(int count, char **arguments)
{
    const motor_t motor = motor_of(count);
    canwright_frame_t frames[FRAMES];
    VALUE sum = 0;
    int failures = 0;
    unsigned i;
    (void)arguments;
    for (i = 0u; i < FRAMES; i++) {
        frames[i].id = CYCLE[i].id;
        frames[i].dlc = 8u;
        memcpy(frames[i].data, CYCLE[i].data, 8u);
    }
    for (i = 0u; i < CYCLES; i++) {
        failures += receive_cycle(&sum, frames, &motor);
    }
    printf("%u\n", CYCLES);
    fprintf(stderr, "%.17g\n", (double)sum);
    return failures;
}
#endif
