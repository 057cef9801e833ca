/**
 * @file
 * Texts and decimal digits, for editions that have them.
 */
#ifndef CANWRIGHT_TEXT_H
#define CANWRIGHT_TEXT_H

#include "canwright.h"

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#endif

/**
 * Copies a text of at most `count` bytes and a 0 after it. The text ends before the first 0, and before the padding at the
 * end. Bytes that are no characters are copied, too. CANWRIGHT_OUT_OF_RANGE if `size` is too small.
 */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_text_read(
    char *text, size_t size, const uint8_t *raw, size_t count, uint8_t padding)
{
    size_t end = 0u;
    size_t i;
    while ((end < count) && (raw[end] != 0u)) {
        end++;
    }
    while ((end > 0u) && (raw[end - 1u] == padding)) {
        end--;
    }
    if (end >= size) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    for (i = 0u; i < end; i++) {
        text[i] = (char)raw[i];
    }
    text[end] = '\0';
    return CANWRIGHT_OK;
}

/**
 * Writes a text and its padding to `count` bytes. CANWRIGHT_OUT_OF_RANGE if it is longer, has a byte above `highest`, or
 * ends with the padding.
 */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_text_write(
    uint8_t *raw, size_t count, uint8_t padding, uint8_t highest, const char *text)
{
    size_t end = 0u;
    size_t i;
    while (text[end] != '\0') {
        if ((end >= count) || ((uint8_t)text[end] > highest)) {
            return CANWRIGHT_OUT_OF_RANGE;
        }
        end++;
    }
    if ((end > 0u) && ((uint8_t)text[end - 1u] == padding)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    for (i = 0u; i < count; i++) {
        raw[i] = (i < end) ? (uint8_t)text[i] : padding;
    }
    return CANWRIGHT_OK;
}

/** The number of `count` decimal digits, the most significant one first. CANWRIGHT_OUT_OF_RANGE if one exceeds 9. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_digits_read(uint64_t *number, const uint8_t *raw, size_t count)
{
    uint64_t sum = 0u;
    size_t i;
    for (i = 0u; i < count; i++) {
        if (raw[i] > 9u) {
            return CANWRIGHT_OUT_OF_RANGE;
        }
        sum = (sum * 10u) + raw[i];
    }
    *number = sum;
    return CANWRIGHT_OK;
}

/** Writes a number to `count` decimal digits. CANWRIGHT_OUT_OF_RANGE if it has more. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_digits_write(uint8_t *raw, size_t count, uint64_t number)
{
    uint64_t rest = number;
    size_t i;
    for (i = count; i > 0u; i--) {
        raw[i - 1u] = (uint8_t)(rest % 10u);
        rest = rest / 10u;
    }
    return (rest == 0u) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
