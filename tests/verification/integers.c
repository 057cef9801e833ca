/* Answers each line "OPERATION NUMBER ...", up to ten unsigned integers, with the result of a function of the runtime. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "canwright_print.h"

#define SIZE 200u

static void print(canwright_printer_t *printer, char operation, const uint64_t *given)
{
    const canwright_ratio_t ratio = {(int32_t)given[4], (uint32_t)given[5]};
    const canwright_linear_t linear = {(int64_t)given[1], (int64_t)given[2], (int64_t)given[3], ratio};
    const unsigned decimals = (unsigned)given[6];
    canwright_frame_t frame;
    switch (operation) {
    case 's':
        canwright_print_value_signed(printer, (int64_t)given[0], &linear, decimals);
        break;
    case 'u':
        canwright_print_value_unsigned(printer, given[0], &linear, decimals);
        break;
    case 'f':
        canwright_print_value_bits32(printer, (uint32_t)given[0], &linear, decimals);
        break;
    case 'd':
        canwright_print_value_bits64(printer, given[0], &linear, decimals);
        break;
    case 'i':
        canwright_print_signed(printer, (int64_t)given[0]);
        break;
    case 'x':
        canwright_print_digits(printer, given[0], (unsigned)given[1], (unsigned)given[2]);
        break;
    default:
        frame.id = (uint32_t)given[1];
        frame.dlc = (uint8_t)given[2];
        memcpy(frame.data, &given[3], sizeof frame.data);
        canwright_print_rejected(printer, (canwright_status_t)given[0], frame.id, frame.dlc, frame.data, CANWRIGHT_MAX_DATA);
        break;
    }
}

/* Prints into the first bytes of a buffer; a line about the rest follows. */
static void show(char operation, const uint64_t *given)
{
    char text[SIZE];
    const size_t size = (size_t)given[7];
    canwright_printer_t printer = {text, size, 0u};
    size_t length;
    size_t i;
    memset(text, '~', sizeof text);
    print(&printer, operation, given);
    length = canwright_print_end(&printer);
    for (i = size; i < SIZE; i++) {
        if (text[i] != '~') {
            printf("overrun ");
        }
    }
    printf("%u %s\n", (unsigned)length, size > 0u ? text : "");
}

static void print_wide(const canwright_wide_t *wide)
{
    unsigned i;
    for (i = CANWRIGHT_WORDS; i > 0u; i--) {
        printf("%08" PRIX32, wide->word[i - 1u]);
    }
}

static void print_term(const canwright_term_t *term)
{
    print_wide(&term->size);
    printf(" %d %d\n", term->exponent, term->negative ? 1 : 0);
}

/* Wide integers of four numbers each, the least significant first; then shifts, factors and bits. */
static void calculate_wide(char operation, const uint64_t *given)
{
    const int count = (int)(int64_t)given[8];
    uint64_t whole = 0u;
    bool fits;
    canwright_term_t term = {{{0u}}, (int)(int64_t)given[9], true};
    canwright_wide_t other;
    size_t i;
    for (i = 0u; i < CANWRIGHT_WORDS; i++) {
        term.size.word[i] = (uint32_t)(given[i / 2u] >> (32u * (i % 2u)));
        other.word[i] = (uint32_t)(given[4u + i / 2u] >> (32u * (i % 2u)));
    }
    switch (operation) {
    case 'A':
        canwright_wide_add(&term.size, &other);
        break;
    case 'B':
        canwright_wide_subtract(&term.size, &other);
        break;
    case 'D':
        fits = canwright_wide_divide(&whole, &term.size, &other, count);
        if (!fits) {
            puts("false");
            return;
        }
        printf("%" PRIX64 " ", whole);
        break;
    case 'E':
        printf("%d\n", canwright_wide_less(&term.size, &other) ? 1 : 0);
        return;
    case 'G':
        printf("%d\n", canwright_wide_length(&term.size));
        return;
    case 'I':
        canwright_wide_left(&term.size, count);
        break;
    case 'J':
        canwright_wide_right(&term.size, count);
        break;
    case 'K':
        canwright_wide_multiply(&term.size, given[4]);
        break;
    case 'T':
        canwright_term_align(&term, count);
        break;
    case 'U':
        canwright_term_single(&term, (uint32_t)given[4]);
        break;
    default:
        canwright_term_double(&term, given[4]);
        break;
    }
    print_term(&term);
}

/* Frames of given[0] and given[1] with the DLC given[2] and given[3], and the ids given[4] and given[5]. */
static void compare_frames(const uint64_t *given)
{
    canwright_frame_t one;
    canwright_frame_t other = CANWRIGHT_ZERO;
    const canwright_filter_t filter = {(uint32_t)given[5], (uint32_t)given[6]};
    memset(&one, 0xFF, sizeof one);
    memcpy(one.data, &given[0], sizeof one.data);
    memcpy(other.data, &given[1], sizeof other.data);
    one.dlc = (uint8_t)given[2];
    other.dlc = (uint8_t)given[3];
    one.id = (uint32_t)given[4];
    printf("%d %d", canwright_same_data(&one, &other) ? 1 : 0, canwright_accepts(&filter, &one) ? 1 : 0);
    canwright_clear(&one);
    printf(" %d %d\n", memcmp(one.reserved, "\0\0\0", 3u), memcmp(one.data, "\0\0\0\0\0\0\0\0", 8u));
}

static void calculate(char operation, const uint64_t *given)
{
    const int64_t one = (int64_t)given[0];
    const canwright_ratio_t ratio = {(int32_t)given[1], (uint32_t)given[2]};
    const int64_t other = (int64_t)given[3];
    const int64_t third = (int64_t)given[4];
    int64_t nearest = 0;
    int64_t result = 0;
    switch (operation) {
    case 'Q':
        result = canwright_divide32((int32_t)one, (int32_t)other);
        break;
    case 'R':
        result = canwright_divide64(one, other);
        break;
    case 'M':
        result = canwright_multiple64(&ratio, one, other);
        break;
    case 'L':
        result = canwright_floor(&ratio, one, third, other);
        break;
    case 'C':
        result = canwright_ceiling(&ratio, one, third, other);
        break;
    case 'H':
        if (!canwright_share64(&nearest, &ratio, one, (int64_t)given[5], other, third, (int64_t)given[6],
                (int64_t)given[7], (int64_t)given[8])) {
            puts("false");
            return;
        }
        result = nearest;
        break;
    case 'W':
        result = canwright_signed32((uint32_t)given[0], (unsigned)given[1]);
        break;
    case 'X':
        result = canwright_signed64(given[0], (unsigned)given[1]);
        break;
    case 'Y':
        result = canwright_signed_words((uint32_t)given[0], (uint32_t)given[1]);
        break;
    case 'O':
        result = (canwright_is_finite32((uint32_t)given[0]) ? 2 : 0) +
            (canwright_order32((uint32_t)given[0]) < canwright_order32((uint32_t)given[1]) ? 1 : 0);
        break;
    default:
        result = (canwright_is_finite64(given[0]) ? 2 : 0) +
            (canwright_order64(given[0]) < canwright_order64(given[1]) ? 1 : 0);
        break;
    }
    printf("%" PRId64 "\n", result);
}

int main(void)
{
    char line[400];
    while (fgets(line, (int)sizeof line, stdin) != NULL) {
        uint64_t given[10] = {0};
        char *next = line + 1;
        size_t i;
        for (i = 0u; i < 10u; i++) {
            given[i] = strtoull(next, &next, 10);
        }
        if (line[0] >= 'a') {
            show(line[0], given);
        } else if (line[0] == 'F') {
            compare_frames(given);
        } else if (strchr("ABDEGIJKTUV", line[0]) != NULL) {
            calculate_wide(line[0], given);
        } else {
            calculate(line[0], given);
        }
    }
    return 0;
}
