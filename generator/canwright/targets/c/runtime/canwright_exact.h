/**
 * @file
 * Exact calculation with scales, in wide integers, that all editions share; included by other headers.
 */
#ifndef CANWRIGHT_EXACT_H
#define CANWRIGHT_EXACT_H

#include "canwright.h"

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wzero-as-null-pointer-constant"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuseless-cast"
#endif
#endif

/** Number of words of a canwright_wide_t. */
#define CANWRIGHT_WORDS 8u

/** The maximum number of bits of a sum without the carry; a rounded result depends on fewer than 160. */
#define CANWRIGHT_SUM_BITS 200

/** value = ratio * (raw * factor + addend) / divisor. `factor` is not 0; `divisor` and `ratio` are above 0. */
typedef struct {
    /** Numerator of the scale. */
    int64_t factor;
    /** Numerator of the offset. */
    int64_t addend;
    /** Denominator of scale and offset. */
    int64_t divisor;
    /** The parameter that multiplies both; {1, 1} without one. */
    canwright_ratio_t ratio;
} canwright_linear_t;

/** An unsigned integer. */
typedef struct {
    /** The least significant word is the first. */
    uint32_t word[CANWRIGHT_WORDS];
} canwright_wide_t;

/** The number `size * 2^exponent`, or its negative. */
typedef struct {
    /** The magnitude without the exponent. */
    canwright_wide_t size;
    /** A power of two. */
    int exponent;
    /** True for a negative number. */
    bool negative;
} canwright_term_t;

/** The number `above / below`. */
typedef struct {
    /** The dividend. */
    canwright_term_t above;
    /** The divisor. */
    canwright_wide_t below;
} canwright_quotient_t;

/** The magnitude of an integer. */
static inline uint64_t canwright_magnitude(int64_t number)
{
    return (number < 0) ? (0u - (uint64_t)number) : (uint64_t)number;
}

/** Sets a wide integer. */
CANWRIGHT_NONNULL
static inline void canwright_wide_set(canwright_wide_t *wide, uint64_t number)
{
    unsigned i;
    wide->word[0] = (uint32_t)number;
    wide->word[1] = (uint32_t)(number >> 32);
    for (i = 2u; i < CANWRIGHT_WORDS; i++) {
        wide->word[i] = 0u;
    }
}

/** Number of bits of a wide integer without its leading zeros. */
CANWRIGHT_NONNULL
static inline int canwright_wide_length(const canwright_wide_t *wide)
{
    unsigned i = CANWRIGHT_WORDS;
    int length;
    uint32_t top;
    while ((i > 1u) && (wide->word[i - 1u] == 0u)) {
        i--;
    }
    length = 32 * ((int)i - 1);
    for (top = wide->word[i - 1u]; top != 0u; top >>= 1) {
        length++;
    }
    return length;
}

/** Shifts a wide integer to the left. */
CANWRIGHT_NONNULL
static inline void canwright_wide_left(canwright_wide_t *wide, int count)
{
    const unsigned words = (unsigned)count / 32u;
    const unsigned bits = (unsigned)count % 32u;
    unsigned i;
    for (i = CANWRIGHT_WORDS; i > 0u; i--) {
        const unsigned to = i - 1u;
        uint64_t pair = (to >= words) ? ((uint64_t)wide->word[to - words] << 32) : 0u;
        if (to > words) {
            pair |= wide->word[to - words - 1u];
        }
        wide->word[to] = (uint32_t)((pair << bits) >> 32);
    }
}

/** Shifts a wide integer to the right; its lowest bit is then 1 if any bit that left it was. */
CANWRIGHT_NONNULL
static inline void canwright_wide_right(canwright_wide_t *wide, int count)
{
    const unsigned words = (unsigned)count / 32u;
    const unsigned bits = (unsigned)count % 32u;
    uint32_t left = 0u;
    unsigned i;
    for (i = 0u; i < CANWRIGHT_WORDS; i++) {
        const unsigned from = i + words;
        uint64_t pair = (from < CANWRIGHT_WORDS) ? wide->word[from] : 0u;
        if ((from + 1u) < CANWRIGHT_WORDS) {
            pair |= (uint64_t)wide->word[from + 1u] << 32;
        }
        if (i < words) {
            left |= wide->word[i];
        } else if (i == words) {
            left |= wide->word[i] & ((UINT32_C(1) << bits) - 1u);
        } else {
            /* This word stays. */
        }
        wide->word[i] = (uint32_t)(pair >> bits);
    }
    if (left != 0u) {
        wide->word[0] |= 1u;
    }
}

/** True if `one` is less than `other`. */
CANWRIGHT_NONNULL
static inline bool canwright_wide_less(const canwright_wide_t *one, const canwright_wide_t *other)
{
    unsigned i;
    for (i = CANWRIGHT_WORDS; i > 0u; i--) {
        if (one->word[i - 1u] != other->word[i - 1u]) {
            return one->word[i - 1u] < other->word[i - 1u];
        }
    }
    return false;
}

/** Adds a wide integer. */
CANWRIGHT_NONNULL
static inline void canwright_wide_add(canwright_wide_t *sum, const canwright_wide_t *other)
{
    uint64_t carry = 0u;
    unsigned i;
    for (i = 0u; i < CANWRIGHT_WORDS; i++) {
        carry += (uint64_t)sum->word[i] + other->word[i];
        sum->word[i] = (uint32_t)carry;
        carry >>= 32;
    }
}

/** Subtracts a wide integer that is not greater. */
CANWRIGHT_NONNULL
static inline void canwright_wide_subtract(canwright_wide_t *rest, const canwright_wide_t *other)
{
    uint64_t borrow = 0u;
    unsigned i;
    for (i = 0u; i < CANWRIGHT_WORDS; i++) {
        const uint64_t difference = (uint64_t)rest->word[i] - other->word[i] - borrow;
        rest->word[i] = (uint32_t)difference;
        borrow = (difference >> 32) & 1u;
    }
}

/** Multiplies a wide integer. */
CANWRIGHT_NONNULL
static inline void canwright_wide_multiply(canwright_wide_t *wide, uint64_t factor)
{
    const uint64_t low = factor & 0xFFFFFFFFu;
    const uint64_t high = factor >> 32;
    uint64_t carry = 0u;
    uint32_t before = 0u;
    unsigned i;
    for (i = 0u; i < CANWRIGHT_WORDS; i++) {
        const uint64_t one = wide->word[i] * low;
        const uint64_t other = before * high;
        const uint64_t sum = (one & 0xFFFFFFFFu) + (other & 0xFFFFFFFFu) + (carry & 0xFFFFFFFFu);
        before = wide->word[i];
        wide->word[i] = (uint32_t)sum;
        carry = (carry >> 32) + (one >> 32) + (other >> 32) + (sum >> 32);
    }
}

/**
 * The whole part of `above * 2^shift / below`; false if it exceeds 64 bits. Afterwards `above` is the remainder of a
 * division by `below`, which is shifted if `shift` is negative.
 */
CANWRIGHT_NONNULL
static inline bool canwright_wide_divide(uint64_t *whole, canwright_wide_t *above, canwright_wide_t *below, int shift)
{
    int count;
    uint64_t lost = 0u;
    if (shift >= 0) {
        canwright_wide_left(above, shift);
    } else {
        canwright_wide_left(below, -shift);
    }
    *whole = 0u;
    if (canwright_wide_length(below) <= 32) {
        uint64_t rest = 0u;
        unsigned i;
        for (i = CANWRIGHT_WORDS; i > 0u; i--) {
            rest = (rest << 32) | above->word[i - 1u];
            lost |= *whole >> 32;
            *whole = (*whole << 32) | (rest / below->word[0]);
            rest %= below->word[0];
        }
        canwright_wide_set(above, rest);
        return lost == 0u;
    }
    count = canwright_wide_length(above) - canwright_wide_length(below);
    if (count > 0) {
        canwright_wide_left(below, count);
    }
    for (; count >= 0; count--) {
        lost |= *whole >> 63;
        *whole <<= 1;
        if (!canwright_wide_less(above, below)) {
            canwright_wide_subtract(above, below);
            *whole |= 1u;
        }
        if (count > 0) {
            canwright_wide_right(below, 1);
        }
    }
    return lost == 0u;
}

/** Sets an integer. */
CANWRIGHT_NONNULL
static inline void canwright_term_integer(canwright_term_t *term, uint64_t size, bool negative)
{
    canwright_wide_set(&term->size, size);
    term->exponent = 0;
    term->negative = negative;
}

/** Sets the number with these bits, which is finite. */
CANWRIGHT_NONNULL
static inline void canwright_term_single(canwright_term_t *term, uint32_t bits)
{
    const uint32_t exponent = (bits >> 23) & 0xFFu;
    const uint32_t fraction = bits & 0x7FFFFFu;
    canwright_wide_set(&term->size, (exponent == 0u) ? fraction : (fraction | 0x800000u));
    term->exponent = ((exponent == 0u) ? 1 : (int)exponent) - 150;
    term->negative = (bits >> 31) != 0u;
}

/** Sets the number with these bits, which is finite. */
CANWRIGHT_NONNULL
static inline void canwright_term_double(canwright_term_t *term, uint64_t bits)
{
    const uint64_t exponent = (bits >> 52) & 0x7FFu;
    const uint64_t fraction = bits & UINT64_C(0xFFFFFFFFFFFFF);
    canwright_wide_set(&term->size, (exponent == 0u) ? fraction : (fraction | UINT64_C(0x10000000000000)));
    term->exponent = ((exponent == 0u) ? 1 : (int)exponent) - 1075;
    term->negative = (bits >> 63) != 0u;
}

/** Multiplies with a power of two so that the exponent becomes `exponent`. */
CANWRIGHT_NONNULL
static inline void canwright_term_align(canwright_term_t *term, int exponent)
{
    if (term->exponent >= exponent) {
        canwright_wide_left(&term->size, term->exponent - exponent);
    } else {
        canwright_wide_right(&term->size, exponent - term->exponent);
    }
    term->exponent = exponent;
}

/**
 * Adds a term of at most 160 bits to another. Only bits that cannot change a rounded result leave the sum; the lowest
 * bit remembers them.
 */
CANWRIGHT_NONNULL
static inline void canwright_term_add(canwright_term_t *sum, canwright_term_t *other)
{
    const int length = canwright_wide_length(&sum->size) + sum->exponent;
    const int other_length = canwright_wide_length(&other->size) + other->exponent;
    const int lowest = ((length > other_length) ? length : other_length) - CANWRIGHT_SUM_BITS;
    const int exponent = (sum->exponent < other->exponent) ? sum->exponent : other->exponent;
    canwright_term_align(sum, (exponent > lowest) ? exponent : lowest);
    canwright_term_align(other, sum->exponent);
    if (sum->negative == other->negative) {
        canwright_wide_add(&sum->size, &other->size);
    } else if (canwright_wide_less(&sum->size, &other->size)) {
        canwright_wide_subtract(&other->size, &sum->size);
        *sum = *other;
    } else {
        canwright_wide_subtract(&sum->size, &other->size);
    }
}

/** The value of a raw number. */
CANWRIGHT_NONNULL
static inline void canwright_value(
    canwright_quotient_t *value, const canwright_term_t *raw, const canwright_linear_t *linear)
{
    const uint64_t numerator = canwright_magnitude(linear->ratio.numerator);
    canwright_term_t addend;
    value->above = *raw;
    value->above.negative = raw->negative != (linear->factor < 0);
    canwright_wide_multiply(&value->above.size, canwright_magnitude(linear->factor));
    canwright_wide_multiply(&value->above.size, numerator);
    if (linear->addend != 0) {
        canwright_term_integer(&addend, canwright_magnitude(linear->addend), linear->addend < 0);
        canwright_wide_multiply(&addend.size, numerator);
        canwright_term_add(&value->above, &addend);
    }
    canwright_wide_set(&value->below, canwright_magnitude(linear->divisor));
    canwright_wide_multiply(&value->below, linear->ratio.denominator);
}

/** The magnitude of the nearest integer, ties away from zero; false if it exceeds 64 bits. */
CANWRIGHT_NONNULL
static inline bool canwright_nearest(uint64_t *nearest, canwright_quotient_t *quotient)
{
    canwright_term_t *above = &quotient->above;
    const int length = canwright_wide_length(&above->size) + above->exponent;
    const int difference = length - canwright_wide_length(&quotient->below);
    if (difference < -1) { /* less than one half */
        *nearest = 0u;
        return true;
    }
    if ((difference > 64) || !canwright_wide_divide(nearest, &above->size, &quotient->below, above->exponent)) {
        return false;
    }
    canwright_wide_left(&above->size, 1);
    if (canwright_wide_less(&above->size, &quotient->below)) {
        return true;
    }
    *nearest += 1u;
    return *nearest != 0u;
}

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
