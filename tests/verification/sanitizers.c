/*
 * Calls every function of a generated header: with LIBFUZZER with the inputs of the fuzzer, else with random ones. An input
 * is the number of a function and the bytes of its arguments. A frame is a golden one with one other byte, or any bytes.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include HEADER

#ifdef CHECKS_MEMORY
#include <sanitizer/msan_interface.h>
#define CHECK(place) __msan_check_mem_is_initialized(&(place), sizeof(place))
#else
#define CHECK(place) ((void)(place))
#endif

#define SIZE 160u

#ifdef CANWRIGHT_FD_H
typedef canwright_fd_frame_t frame_t;
#else
typedef canwright_frame_t frame_t;
#endif

typedef struct {
    uint32_t id;
    uint8_t dlc;
    uint8_t data[sizeof((frame_t *)0)->data];
} golden_t;

static const uint8_t *input;
static size_t left;

/* Copies the next bytes of the input, then zeros. */
static void take(void *to, size_t size)
{
    const size_t some = size < left ? size : left;
    memset(to, 0, size);
    memcpy(to, input, some);
    input += some;
    left -= some;
}

static void take_frame(frame_t *frame);

#include "calls.h"

static void take_frame(frame_t *frame)
{
    uint8_t choice[4];
    take(choice, sizeof choice);
    take(frame, sizeof *frame);
    if ((choice[0] & 7u) != 0u) {
        const golden_t *golden = &GOLDEN[((choice[0] >> 3) + 32u * choice[1]) % (sizeof GOLDEN / sizeof GOLDEN[0])];
        frame->id = golden->id;
        frame->dlc = golden->dlc;
        memcpy(frame->data, golden->data, sizeof frame->data);
        frame->data[choice[2] % sizeof frame->data] ^= choice[3];
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint16_t number;
    input = data;
    left = size;
    take(&number, sizeof number);
    CALLS[number % (sizeof CALLS / sizeof CALLS[0])]();
    return 0;
}

#ifndef LIBFUZZER

/* Random inputs, a given number of them for each function. */
int main(int count, char **arguments)
{
    const unsigned long rounds = count > 1 ? strtoul(arguments[1], NULL, 10) : 0u;
    const unsigned functions = sizeof CALLS / sizeof CALLS[0];
    uint64_t state = UINT64_C(0x9E3779B97F4A7C15);
    unsigned long i;
    for (i = 0u; i < rounds * functions; i++) {
        uint8_t data[SIZE];
        const uint16_t number = (uint16_t)(i % functions);
        size_t k;
        for (k = 0u; k < SIZE; k++) {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            data[k] = (uint8_t)(state >> 32);
        }
        memcpy(data, &number, sizeof number);
        LLVMFuzzerTestOneInput(data, (state & 1u) != 0u ? SIZE : (size_t)(2u + (state >> 40) % (SIZE - 2u)));
    }
    printf("%u functions\n", functions);
    return 0;
}

#endif
