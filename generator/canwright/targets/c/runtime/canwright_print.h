/**
 * @file
 * Frames as text, for all editions: integers only, without printf and heap.
 */
#ifndef CANWRIGHT_PRINT_H
#define CANWRIGHT_PRINT_H

#include "canwright_exact.h"

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wzero-as-null-pointer-constant"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuseless-cast"
#endif
#endif

/** A text that is being printed. */
typedef struct {
    /** Where the text is stored. */
    char *text;
    /** The size of `text`, with the zero at the end. */
    size_t size;
    /** The length of the complete text, even if `size` is too small. */
    size_t length;
} canwright_printer_t;

/** Prints a character. */
CANWRIGHT_NONNULL
static inline void canwright_print_character(canwright_printer_t *printer, char character)
{
    if ((printer->size > 1u) && (printer->length < (printer->size - 1u))) {
        printer->text[printer->length] = character;
    }
    printer->length++;
}

/** Prints a text. */
CANWRIGHT_NONNULL
static inline void canwright_print_text(canwright_printer_t *printer, const char *text)
{
    const char *next;
    for (next = text; *next != '\0'; next++) {
        canwright_print_character(printer, *next);
    }
}

/** Ends the text with a zero, and returns its length without it; `size` was too small unless it is greater. */
CANWRIGHT_NONNULL
static inline size_t canwright_print_end(canwright_printer_t *printer)
{
    if (printer->size > 0u) {
        printer->text[(printer->length < printer->size) ? printer->length : (printer->size - 1u)] = '\0';
    }
    return printer->length;
}

/** Prints an integer with at least `digits` digits, one or more. */
CANWRIGHT_NONNULL
static inline void canwright_print_digits(canwright_printer_t *printer, uint64_t number, unsigned base, unsigned digits)
{
    char reversed[20];
    uint64_t rest = number;
    unsigned count = 0u;
    do {
        const unsigned digit = (unsigned)(rest % base);
        reversed[count] = "0123456789ABCDEF"[digit];
        rest /= base;
        count++;
    } while ((rest != 0u) || (count < digits));
    while (count > 0u) {
        count--;
        canwright_print_character(printer, reversed[count]);
    }
}

/** Prints an integer. */
CANWRIGHT_NONNULL
static inline void canwright_print_unsigned(canwright_printer_t *printer, uint64_t number)
{
    canwright_print_digits(printer, number, 10u, 1u);
}

/** Prints an integer. */
CANWRIGHT_NONNULL
static inline void canwright_print_signed(canwright_printer_t *printer, int64_t number)
{
    if (number < 0) {
        canwright_print_character(printer, '-');
    }
    canwright_print_unsigned(printer, canwright_magnitude(number));
}

/** Prints the value of a raw number, rounded to the nearest with at most some decimals, ties away from zero. */
CANWRIGHT_NONNULL
static inline void canwright_print_value(canwright_printer_t *printer, const canwright_term_t *raw,
    const canwright_linear_t *linear, unsigned decimals)
{
    canwright_quotient_t value;
    uint64_t power = 1u;
    uint64_t nearest;
    uint64_t rest;
    unsigned places;
    for (places = 0u; places < decimals; places++) {
        power *= 10u;
    }
    for (;;) {
        canwright_value(&value, raw, linear);
        canwright_wide_multiply(&value.above.size, power);
        if (canwright_nearest(&nearest, &value)) {
            break;
        }
        if (places == 0u) { /* beyond 64 bits */
            canwright_print_text(printer, value.above.negative ? "<-" : ">");
            canwright_print_unsigned(printer, UINT64_MAX);
            return;
        }
        places--;
        power /= 10u;
    }
    if (value.above.negative && (nearest != 0u)) {
        canwright_print_character(printer, '-');
    }
    canwright_print_unsigned(printer, nearest / power);
    rest = nearest % power;
    if (rest != 0u) {
        while ((rest % 10u) == 0u) {
            rest /= 10u;
            places--;
        }
        canwright_print_character(printer, '.');
        canwright_print_digits(printer, rest, 10u, places);
    }
}

/** Prints the value of a signed integer. */
CANWRIGHT_NONNULL
static inline void canwright_print_value_signed(
    canwright_printer_t *printer, int64_t raw, const canwright_linear_t *linear, unsigned decimals)
{
    canwright_term_t term;
    canwright_term_integer(&term, canwright_magnitude(raw), raw < 0);
    canwright_print_value(printer, &term, linear, decimals);
}

/** Prints the value of an unsigned integer. */
CANWRIGHT_NONNULL
static inline void canwright_print_value_unsigned(
    canwright_printer_t *printer, uint64_t raw, const canwright_linear_t *linear, unsigned decimals)
{
    canwright_term_t term;
    canwright_term_integer(&term, raw, false);
    canwright_print_value(printer, &term, linear, decimals);
}

/** Prints the value of the 32-bit number that has these bits. */
CANWRIGHT_NONNULL
static inline void canwright_print_value_bits32(
    canwright_printer_t *printer, uint32_t raw, const canwright_linear_t *linear, unsigned decimals)
{
    canwright_term_t term;
    if (!canwright_is_finite32(raw)) {
        canwright_print_text(printer, ((raw << 9) != 0u) ? "nan" : (((raw >> 31) != 0u) ? "-inf" : "inf"));
        return;
    }
    canwright_term_single(&term, raw);
    canwright_print_value(printer, &term, linear, decimals);
}

/** Prints the value of the 64-bit number that has these bits. */
CANWRIGHT_NONNULL
static inline void canwright_print_value_bits64(
    canwright_printer_t *printer, uint64_t raw, const canwright_linear_t *linear, unsigned decimals)
{
    canwright_term_t term;
    if (!canwright_is_finite64(raw)) {
        canwright_print_text(printer, ((raw << 12) != 0u) ? "nan" : (((raw >> 63) != 0u) ? "-inf" : "inf"));
        return;
    }
    canwright_term_double(&term, raw);
    canwright_print_value(printer, &term, linear, decimals);
}

/** Prints a frame that is rejected, at most `most` bytes of it, and why: `unknown_code: 141 [2] 99 00`. */
CANWRIGHT_NONNULL
static inline void canwright_print_rejected(
    canwright_printer_t *printer, canwright_status_t status, uint32_t id, uint8_t dlc, const uint8_t *data, uint8_t most)
{
    const bool is_extended = (id & CANWRIGHT_EXTENDED) != 0u;
    unsigned i;
    canwright_print_text(printer, canwright_status_name(status));
    canwright_print_text(printer, ": ");
    canwright_print_digits(printer, id & 0x1FFFFFFFu, 16u, is_extended ? 8u : 3u);
    canwright_print_text(printer, " [");
    canwright_print_unsigned(printer, dlc);
    canwright_print_character(printer, ']');
    if ((id & CANWRIGHT_REMOTE) != 0u) {
        canwright_print_text(printer, " remote");
        return;
    }
    for (i = 0u; (i < dlc) && (i < most); i++) {
        canwright_print_character(printer, ' ');
        canwright_print_digits(printer, data[i], 16u, 2u);
    }
}

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
