/**
 * @file
 * Conversions to and from floating point that all editions share; in a separate file for programs without floating point.
 *
 * A value is converted to a raw integer by one operation a step: minus the offset, times the denominator of the scale,
 * divided by its numerator; then to the nearest integer, ties away from zero. So 0.15 at 0.1 per LSB is 2. From 2^51 LSB
 * on, the quotient of doubles is corrected to the exact result. Functions for `float` use neither `double` nor this.
 * Nothing needs a mathematical library.
 */
#ifndef CANWRIGHT_FLOAT_H
#define CANWRIGHT_FLOAT_H

#include <float.h>

#include "canwright.h"

#if defined(FLT_MANT_DIG) && FLT_MANT_DIG != 24
#error "Conversions to float need 32-bit IEEE 754 numbers, which this compiler does not have; use thousandths."
#endif

#if defined(DBL_MANT_DIG) && DBL_MANT_DIG != 53
#define CANWRIGHT_HAS_DOUBLE 0 /**< There are no conversions to and from double. */
#else
#define CANWRIGHT_HAS_DOUBLE 1 /**< A double is a 64-bit IEEE 754 number. */
#endif

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wzero-as-null-pointer-constant"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuseless-cast"
#endif
#endif

/** The bits of a 32-bit number. */
static inline uint32_t canwright_bits_of_float(float number)
{
    uint32_t bits = 0u;
    const unsigned char *from = (const unsigned char *)&number;
    unsigned char *to = (unsigned char *)&bits;
    size_t i;
    for (i = 0u; i < sizeof bits; i++) {
        to[i] = from[i];
    }
    return bits;
}

/** The 32-bit number that has these bits. */
static inline float canwright_float_of_bits(uint32_t bits)
{
    float number = 0.0f;
    const unsigned char *from = (const unsigned char *)&bits;
    unsigned char *to = (unsigned char *)&number;
    size_t i;
    for (i = 0u; i < sizeof number; i++) {
        to[i] = from[i];
    }
    return number;
}

/** `ratio * dividend / divisor`, divided once; `ratio` is above 0. */
CANWRIGHT_NONNULL
static inline float canwright_multiple_float(const canwright_ratio_t *ratio, float dividend, float divisor)
{
    const float numerator = (float)ratio->numerator;
    const float denominator = (float)ratio->denominator;
    return (dividend * numerator) / (divisor * denominator);
}

/** `value / ratio`; `ratio` is above 0. */
CANWRIGHT_NONNULL
static inline float canwright_share_float(float value, const canwright_ratio_t *ratio)
{
    const float numerator = (float)ratio->numerator;
    const float denominator = (float)ratio->denominator;
    return (value * denominator) / numerator;
}

/** The integer nearest to `steps`, ties away from zero; `steps` was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_signed32_from_float(
    int32_t *nearest, float value, float steps, int32_t lowest, int32_t highest)
{
    int32_t whole;
    float rest;
    if (!canwright_is_finite32(canwright_bits_of_float(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!((steps >= -2147483648.0f) && (steps < 2147483648.0f))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (int32_t)steps;
    rest = steps - (float)whole;
    *nearest = whole + ((rest >= 0.5f) ? 1 : 0) - ((rest <= -0.5f) ? 1 : 0);
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The same for 64 bits. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_signed64_from_float(
    int64_t *nearest, float value, float steps, int64_t lowest, int64_t highest)
{
    int64_t whole;
    float rest;
    if (!canwright_is_finite32(canwright_bits_of_float(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!((steps >= -9223372036854775808.0f) && (steps < 9223372036854775808.0f))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (int64_t)steps;
    rest = steps - (float)whole;
    *nearest = whole + ((rest >= 0.5f) ? 1 : 0) - ((rest <= -0.5f) ? 1 : 0);
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The same for unsigned numbers of 64 bits. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_unsigned64_from_float(
    uint64_t *nearest, float value, float steps, uint64_t lowest, uint64_t highest)
{
    uint64_t whole;
    if (!canwright_is_finite32(canwright_bits_of_float(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!((steps > -0.5f) && (steps < 18446744073709551616.0f))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (steps < 0.0f) ? 0u : (uint64_t)steps;
    *nearest = whole + (((steps - (float)whole) >= 0.5f) ? 1u : 0u);
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The 32-bit number nearest to the 64-bit number that has these bits, ties to even. */
static inline float canwright_float_of_bits64(uint64_t bits)
{
    const uint32_t sign = (uint32_t)(bits >> 32) & 0x80000000u;
    const uint64_t biased = (bits >> 52) & 0x7FFu;
    const int exponent = (int)biased - (1023 - 127);
    uint64_t fraction = bits & UINT64_C(0xFFFFFFFFFFFFF);
    uint32_t nearest;
    if (!canwright_is_finite64(bits)) {
        return canwright_float_of_bits(sign | 0x7F800000u | ((fraction != 0u) ? 0x400000u : 0u));
    }
    if (exponent >= 255) {
        return canwright_float_of_bits(sign | 0x7F800000u);
    }
    if (exponent < -23) { /* less than half of the smallest number */
        return canwright_float_of_bits(sign);
    }
    if (exponent <= 0) { /* subnormal; the bits that leave the fraction stay in its lowest one */
        const unsigned shift = 1u - (unsigned)exponent;
        fraction |= UINT64_C(0x10000000000000);
        fraction = (fraction >> shift) | (((fraction & ((UINT64_C(1) << shift) - 1u)) != 0u) ? 1u : 0u);
    } else {
        fraction += (uint64_t)exponent << 52;
    }
    nearest = (uint32_t)(fraction >> 29);
    fraction &= 0x1FFFFFFFu;
    if ((fraction > 0x10000000u) || ((fraction == 0x10000000u) && ((nearest & 1u) != 0u))) {
        nearest++;
    }
    return canwright_float_of_bits(sign | nearest);
}

/** The bits of the 32-bit number `steps`, which was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits32_from_float(uint32_t *bits, float value, float steps)
{
    if (!canwright_is_finite32(canwright_bits_of_float(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    *bits = canwright_bits_of_float(steps);
    return canwright_is_finite32(*bits) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The bits of the 64-bit number that equals `steps`, which was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits64_from_float(uint64_t *bits, float value, float steps)
{
    uint32_t single;
    const canwright_status_t status = canwright_bits32_from_float(&single, value, steps);
    uint64_t exponent;
    uint64_t fraction;
    if (status != CANWRIGHT_OK) {
        return status;
    }
    exponent = ((uint64_t)single >> 23) & 0xFFu;
    fraction = (uint64_t)single & 0x7FFFFFu;
    *bits = (uint64_t)(single >> 31) << 63;
    if ((exponent == 0u) && (fraction != 0u)) { /* subnormal */
        exponent = 1u;
        while ((fraction >> 23) == 0u) {
            fraction <<= 1;
            exponent--;
        }
        fraction &= 0x7FFFFFu;
        *bits |= (exponent + (1023u - 127u)) << 52;
    } else if (exponent != 0u) {
        *bits |= (exponent + (1023u - 127u)) << 52;
    } else {
        /* The exponent of zero is 0. */
    }
    *bits |= fraction << 29;
    return CANWRIGHT_OK;
}

#if CANWRIGHT_HAS_DOUBLE

/** The bits of a 64-bit number. */
static inline uint64_t canwright_bits_of_double(double number)
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
static inline double canwright_double_of_bits(uint64_t bits)
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

/** `ratio * dividend / divisor`, divided once; `ratio` is above 0. */
CANWRIGHT_NONNULL
static inline double canwright_multiple_double(const canwright_ratio_t *ratio, double dividend, double divisor)
{
    const double numerator = (double)ratio->numerator;
    const double denominator = (double)ratio->denominator;
    return (dividend * numerator) / (divisor * denominator);
}

/** `value / ratio`; `ratio` is above 0. */
CANWRIGHT_NONNULL
static inline double canwright_share_double(double value, const canwright_ratio_t *ratio)
{
    const double numerator = (double)ratio->numerator;
    const double denominator = (double)ratio->denominator;
    return (value * denominator) / numerator;
}

/** The integer nearest to `steps`, ties away from zero; `steps` was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_signed32_from_double(
    int32_t *nearest, double value, double steps, int32_t lowest, int32_t highest)
{
    int32_t whole;
    double rest;
    if (!canwright_is_finite64(canwright_bits_of_double(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!((steps > -2147483648.5) && (steps < 2147483647.5))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (int32_t)steps;
    rest = steps - (double)whole;
    *nearest = whole + ((rest >= 0.5) ? 1 : 0) - ((rest <= -0.5) ? 1 : 0);
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The same for 64 bits. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_signed64_from_double(
    int64_t *nearest, double value, double steps, int64_t lowest, int64_t highest)
{
    int64_t whole;
    double rest;
    if (!canwright_is_finite64(canwright_bits_of_double(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!((steps >= -9223372036854775808.0) && (steps < 9223372036854775808.0))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (int64_t)steps;
    rest = steps - (double)whole;
    *nearest = whole + ((rest >= 0.5) ? 1 : 0) - ((rest <= -0.5) ? 1 : 0);
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The same for unsigned numbers of 64 bits. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_unsigned64_from_double(
    uint64_t *nearest, double value, double steps, uint64_t lowest, uint64_t highest)
{
    uint64_t whole;
    if (!canwright_is_finite64(canwright_bits_of_double(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!((steps > -0.5) && (steps < 18446744073709551616.0))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (steps < 0.0) ? 0u : (uint64_t)steps;
    *nearest = whole + (((steps - (double)whole) >= 0.5) ? 1u : 0u);
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** `dividend / divisor`, rounded once; `divisor` is from 1 to 2^63. */
static inline double canwright_quotient_unsigned(uint64_t dividend, uint64_t divisor)
{
    uint64_t bits = dividend;
    uint64_t whole = 0u;
    uint64_t rest = 0u;
    unsigned steps;
    if (((dividend | divisor) >> 53) == 0u) { /* both are doubles */
        return (double)dividend / (double)divisor;
    }
    /* Bit by bit: a small processor has no division of 64 bits, and few raw integers are so large. 55 bits decide, with one
       that stands for all below. */
    for (steps = 0u; (steps < 64u) || (((whole >> 54) == 0u) && (rest != 0u)); steps++) {
        rest = (rest << 1) | (bits >> 63);
        bits <<= 1;
        whole = (whole << 1) | ((rest >= divisor) ? 1u : 0u);
        rest -= (rest >= divisor) ? divisor : 0u;
    }
    whole |= (rest != 0u) ? 1u : 0u;
    return (double)whole * canwright_double_of_bits((uint64_t)(1023u + 64u - steps) << 52); /* 2^(64 - steps) */
}

/** The same for a signed dividend. */
static inline double canwright_quotient_signed(int64_t dividend, uint64_t divisor)
{
    const uint64_t size = (dividend < 0) ? (0u - (uint64_t)dividend) : (uint64_t)dividend;
    const double quotient = canwright_quotient_unsigned(size, divisor);
    return (dividend < 0) ? -quotient : quotient;
}

/** The bits of the 64-bit number `steps`, which was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits64_from_double(uint64_t *bits, double value, double steps)
{
    if (!canwright_is_finite64(canwright_bits_of_double(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    *bits = canwright_bits_of_double(steps);
    return canwright_is_finite64(*bits) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The bits of the 32-bit number nearest to `steps`, which was computed from `value`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits32_from_double(uint32_t *bits, double value, double steps)
{
    /* Halfway from the greatest 32-bit number to the next one if there were more exponents. */
    const double limit = 3.4028235677973366e+38;
    if (!canwright_is_finite64(canwright_bits_of_double(value))) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!((steps > -limit) && (steps < limit))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    *bits = canwright_bits_of_float((float)steps);
    return CANWRIGHT_OK;
}

/** True if a quotient in floating point is too coarse for the nearest integer, which may fit in 64 bits. */
static inline bool canwright_is_coarse(double steps)
{
    const double size = (steps < 0.0) ? -steps : steps;
    return (size >= 2251799813685248.0) && (size < 18446744073709568000.0); /* 2^51; 2^64 and the error of a quotient */
}

/**
 * The magnitude of the integer nearest to (value * divisor - addend) / factor; false if it exceeds 64 bits. `steps` is
 * this quotient in floating point, and coarse; divisor and addend are modulo 2^64; the magnitudes of divisor and factor are
 * at most 2^45. The error of `steps` is less than 2^14, so that arithmetic modulo 2^64 determines it. The result is exact,
 * but for a value that is so much smaller than the offset that 2^-47 does not resolve its last bits: it is within one then.
 */
CANWRIGHT_NONNULL
static inline bool canwright_corrected(
    uint64_t *nearest, double value, double steps, uint64_t divisor, uint64_t addend, uint64_t factor)
{
    const uint64_t bits = canwright_bits_of_double(value);
    const double size = (steps < 0.0) ? -steps : steps;
    const uint64_t biased = (bits >> 52) & 0x7FFu;
    uint64_t given = (bits & UINT64_C(0xFFFFFFFFFFFFF)) | UINT64_C(0x10000000000000);
    uint64_t rest;
    uint64_t unit;
    unsigned shift = 1u;
    int left = (int)biased - 1074; /* value = given * 2^(left - shift), except for subnormal numbers, which are too small */
    while ((left < 0) && ((factor << shift) < (UINT64_C(1) << 47))) {
        shift++;
        left++;
    }
    if (left < -63) {
        given = 0u;
    } else if (left < 0) {
        given >>= (unsigned)(-left);
    } else {
        given <<= (unsigned)left & 63u; /* less than 64, as the quotient is less than 2^65 */
    }
    *nearest = (size < 18446744073709551616.0) ? (uint64_t)size : UINT64_MAX;
    unit = factor << shift;
    if ((bits >> 63) != 0u) {
        given = 0u - given;
    }
    rest = (given * divisor) - (addend << shift);
    if (steps < 0.0) {
        rest = 0u - rest;
    }
    rest += unit >> 1;
    rest -= *nearest * unit;
    if ((rest >> 63) != 0u) {
        *nearest -= (unit - 1u - rest) / unit;
        return true;
    }
    *nearest += rest / unit;
    return *nearest >= (rest / unit);
}

/** The integer nearest to `steps`, corrected to the one nearest to (value * divisor - addend) / factor. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_corrected_signed_from_double(int64_t *nearest, double value, double steps,
    uint64_t divisor, uint64_t addend, uint64_t factor, int64_t lowest, int64_t highest)
{
    uint64_t size;
    if (!canwright_is_coarse(steps)) {
        return canwright_signed64_from_double(nearest, value, steps, lowest, highest);
    }
    if (!canwright_corrected(&size, value, steps, divisor, addend, factor)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    if (steps < 0.0) {
        size--; /* -2^63 has no magnitude in 63 bits */
    }
    if (size > (uint64_t)INT64_MAX) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    *nearest = (steps < 0.0) ? (-(int64_t)size - 1) : (int64_t)size;
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The same for unsigned numbers. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_corrected_unsigned_from_double(uint64_t *nearest, double value, double steps,
    uint64_t divisor, uint64_t addend, uint64_t factor, uint64_t lowest, uint64_t highest)
{
    if ((steps < 0.0) || !canwright_is_coarse(steps)) {
        return canwright_unsigned64_from_double(nearest, value, steps, lowest, highest);
    }
    if (!canwright_corrected(nearest, value, steps, divisor, addend, factor)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

#endif

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
