/**
 * @file
 * Conversions to and from double that all editions share; in a separate file for programs without floating point.
 */
#ifndef CANWRIGHT_FLOAT_H
#define CANWRIGHT_FLOAT_H

#include <float.h>

#include "canwright.h"

#if DBL_MANT_DIG != 53 || FLT_MANT_DIG != 24
#error "Conversions to double need 64-bit IEEE 754 numbers, which this compiler does not have; use thousandths."
#endif

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wzero-as-null-pointer-constant"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuseless-cast"
#endif
#endif

/** A double represents every integer up to this one. */
#define CANWRIGHT_EXACT (UINT64_C(1) << 53)

/** The bits of a 64-bit number. */
static inline uint64_t canwright_bits_of(double number)
{
    uint64_t bits = 0u;
    const unsigned char *from = (const unsigned char *)&number;
    unsigned char *to = (unsigned char *)&bits;
    size_t i;
    for (i = 0u; i < sizeof bits; i++) {
        to[i] = from[i];
    }
    return bits;
}

/** The 64-bit number that has these bits. */
static inline double canwright_number64(uint64_t bits)
{
    double number = 0.0;
    const unsigned char *from = (const unsigned char *)&bits;
    unsigned char *to = (unsigned char *)&number;
    size_t i;
    for (i = 0u; i < sizeof number; i++) {
        to[i] = from[i];
    }
    return number;
}

/** The 32-bit number that has these bits. */
static inline double canwright_number32(uint32_t bits)
{
    float number = 0.0f;
    const unsigned char *from = (const unsigned char *)&bits;
    unsigned char *to = (unsigned char *)&number;
    size_t i;
    for (i = 0u; i < sizeof number; i++) {
        to[i] = from[i];
    }
    return (double)number;
}

/** `raw * factor / divisor`, rounded once even if the product fits in 64 bits but not exactly in a double. */
static inline double canwright_quotient_unsigned(uint64_t raw, uint64_t factor, uint64_t divisor)
{
    if (raw <= UINT64_MAX / factor && raw * factor > CANWRIGHT_EXACT) {
        const uint64_t whole = raw * factor / divisor;
        const uint64_t low = whole > CANWRIGHT_EXACT ? whole % 2048u : 0u;
        const double rest = (double)(raw * factor % divisor) / (double)divisor;
        return (double)(whole - low) + ((double)low + rest);
    }
    return (double)raw * (double)factor / (double)divisor;
}

/** The same for signed numbers. */
static inline double canwright_quotient(int64_t raw, uint64_t factor, uint64_t divisor)
{
    return raw < 0 ? -canwright_quotient_unsigned(0u - (uint64_t)raw, factor, divisor)
                   : canwright_quotient_unsigned((uint64_t)raw, factor, divisor);
}

/** `ratio * dividend / divisor`, divided once; `ratio` is above 0. */
CANWRIGHT_NONNULL
static inline double canwright_multiple(const canwright_ratio_t *ratio, double dividend, double divisor)
{
    return dividend * (double)ratio->numerator / (divisor * (double)ratio->denominator);
}

/** `value / ratio`; `ratio` is above 0. */
CANWRIGHT_NONNULL
static inline double canwright_share(double value, const canwright_ratio_t *ratio)
{
    return value * (double)ratio->denominator / (double)ratio->numerator;
}

/** The bits of the 64-bit number `steps`, which was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits64(uint64_t *bits, double value, double steps)
{
    if (!canwright_is_finite64(canwright_bits_of(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    *bits = canwright_bits_of(steps);
    return canwright_is_finite64(*bits) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The bits of the 32-bit number nearest to `steps`, which was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits32(uint32_t *bits, double value, double steps)
{
    /* Halfway from the greatest 32-bit number to the next one if there were more exponents. */
    const double limit = 3.4028235677973366e+38;
    float number;
    const unsigned char *from = (const unsigned char *)&number;
    unsigned char *to = (unsigned char *)bits;
    size_t i;
    if (!canwright_is_finite64(canwright_bits_of(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!(steps > -limit && steps < limit)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    number = (float)steps;
    for (i = 0u; i < sizeof number; i++) {
        to[i] = from[i];
    }
    return CANWRIGHT_OK;
}

/** The integer nearest to `steps`, ties away from zero; `steps` was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_nearest(
    int64_t *nearest, double value, double steps, int64_t lowest, int64_t highest)
{
    int64_t whole;
    double rest;
    if (!canwright_is_finite64(canwright_bits_of(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!(steps >= -9223372036854775808.0 && steps < 9223372036854775808.0)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (int64_t)steps;
    rest = steps - (double)whole;
    if (rest >= 0.5) {
        whole += 1;
    } else if (rest <= -0.5) {
        whole -= 1;
    }
    *nearest = whole;
    return whole >= lowest && whole <= highest ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The same for unsigned numbers. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_nearest_unsigned(
    uint64_t *nearest, double value, double steps, uint64_t lowest, uint64_t highest)
{
    uint64_t whole;
    if (!canwright_is_finite64(canwright_bits_of(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!(steps > -0.5 && steps < 18446744073709551616.0)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = steps < 0.0 ? 0u : (uint64_t)steps;
    if (steps - (double)whole >= 0.5) {
        whole += 1u;
    }
    *nearest = whole;
    return whole >= lowest && whole <= highest ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
