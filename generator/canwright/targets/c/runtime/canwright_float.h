/**
 * @file
 * Conversions to and from floating point that all editions share; in a separate file for programs without floating point.
 *
 * Every result is exact or correctly rounded: to the nearest number, ties to even; to the nearest raw integer, ties
 * away from zero. Where floating point cannot decide this, wide integers do. Nothing needs a mathematical library.
 */
#ifndef CANWRIGHT_FLOAT_H
#define CANWRIGHT_FLOAT_H

#include <float.h>

#include "canwright_exact.h"

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

/** Precision of a 32-bit IEEE 754 number. */
#define CANWRIGHT_SINGLE 24u

/** Precision of a 64-bit IEEE 754 number. */
#define CANWRIGHT_DOUBLE 53u

/** The bits of the nearest IEEE 754 number of this precision, ties to even; infinity if there is none. */
CANWRIGHT_NONNULL
static inline uint64_t canwright_rounded(canwright_quotient_t *quotient, unsigned precision)
{
    const bool is_single = precision == CANWRIGHT_SINGLE;
    const unsigned place = precision - 1u;
    int lowest = -1074;
    const uint64_t infinity = is_single ? UINT64_C(0x7F800000) : UINT64_C(0x7FF0000000000000);
    const uint64_t sign = is_single ? (uint64_t)0x80000000u : 0x8000000000000000u;
    canwright_term_t *above = &quotient->above;
    const int length = canwright_wide_length(&above->size);
    const int shift = 62 + canwright_wide_length(&quotient->below) - length;
    int exponent = above->exponent - shift;
    int count = 62 - (int)precision;
    uint64_t whole;
    uint64_t rest;
    uint64_t half;
    if (is_single) {
        lowest = -149;
    }
    if (length == 0) {
        return 0u;
    }
    (void)canwright_wide_divide(&whole, &above->size, &quotient->below, shift); /* 62 or 63 bits */
    if (canwright_wide_length(&above->size) > 0) {
        whole |= 1u;
    }
    if ((whole >> 62) != 0u) {
        count++;
    }
    if ((exponent + count) < lowest) {
        count = lowest - exponent;
    }
    if (count > 63) {
        count = 63;
        exponent = lowest - count;
        whole = 1u;
    }
    half = UINT64_C(1) << ((unsigned)count - 1u);
    rest = whole & ((half << 1) - 1u);
    whole >>= (unsigned)count;
    if ((rest > half) || ((rest == half) && ((whole & 1u) != 0u))) {
        whole++;
    }
    exponent += count - lowest;
    whole += (uint64_t)exponent << place;
    return ((whole < infinity) ? whole : infinity) | (above->negative ? sign : 0u);
}

/** The bits of the value of a raw number, rounded to this precision. */
CANWRIGHT_NONNULL
static inline uint64_t canwright_value_bits(
    const canwright_term_t *raw, const canwright_linear_t *linear, unsigned precision)
{
    canwright_quotient_t value;
    canwright_value(&value, raw, linear);
    return canwright_rounded(&value, precision);
}

/** The bits of the raw number of a value, rounded to this precision. */
CANWRIGHT_NONNULL
static inline uint64_t canwright_raw_bits(
    const canwright_term_t *value, const canwright_linear_t *linear, unsigned precision)
{
    canwright_quotient_t raw;
    canwright_raw(&raw, value, linear);
    return canwright_rounded(&raw, precision);
}

/** True if the value is the raw number. */
CANWRIGHT_NONNULL
static inline bool canwright_is_identity(const canwright_linear_t *linear)
{
    return (linear->factor == 1) && (linear->addend == 0) && (linear->divisor == 1) &&
        (linear->ratio.numerator == 1) && (linear->ratio.denominator == 1u);
}

/** The raw integer nearest to a value, if it is from `lowest` to `highest`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_signed_from_term(int64_t *nearest, const canwright_term_t *value,
    const canwright_linear_t *linear, int64_t lowest, int64_t highest)
{
    canwright_quotient_t raw;
    canwright_raw(&raw, value, linear);
    if (!canwright_nearest_signed(nearest, &raw)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The raw integer nearest to a value, if it is from `lowest` to `highest`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_unsigned_from_term(uint64_t *nearest, const canwright_term_t *value,
    const canwright_linear_t *linear, uint64_t lowest, uint64_t highest)
{
    canwright_quotient_t raw;
    canwright_raw(&raw, value, linear);
    if (!canwright_nearest_unsigned(nearest, &raw)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

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

/** The magnitude of a number. */
static inline float canwright_float_magnitude(float number)
{
    return (number < 0.0f) ? -number : number;
}

/** The value of the integer of a sign and a magnitude. */
CANWRIGHT_NONNULL
static inline float canwright_integer_to_float(bool negative, uint64_t raw, const canwright_linear_t *linear)
{
    const float limit = 16777216.0f; /* integers up to this one are exact */
    const float factor = (float)linear->factor;
    const float addend = (float)linear->addend;
    const float numerator = (float)linear->ratio.numerator;
    const float below = (float)linear->divisor * (float)linear->ratio.denominator;
    const float size = (float)raw;
    const float most = ((size * canwright_float_magnitude(factor)) + canwright_float_magnitude(addend)) * numerator;
    canwright_term_t term;
    if ((most < limit) && (below < limit)) {
        return (((negative ? -size : size) * factor) + addend) * numerator / below;
    }
    canwright_term_integer(&term, raw, negative);
    return canwright_float_of_bits((uint32_t)canwright_value_bits(&term, linear, CANWRIGHT_SINGLE));
}

/** The value of a signed integer. */
CANWRIGHT_NONNULL
static inline float canwright_signed_to_float(int64_t raw, const canwright_linear_t *linear)
{
    return canwright_integer_to_float(raw < 0, canwright_magnitude(raw), linear);
}

/** The value of an unsigned integer. */
CANWRIGHT_NONNULL
static inline float canwright_unsigned_to_float(uint64_t raw, const canwright_linear_t *linear)
{
    return canwright_integer_to_float(false, raw, linear);
}

/** The raw integer nearest to a value if the precision of a float is enough to decide which one this is; else false. */
CANWRIGHT_NONNULL
static inline bool canwright_float_decides(int64_t *nearest, float value, const canwright_linear_t *linear)
{
    const float scaled = value * ((float)linear->divisor * (float)linear->ratio.denominator);
    const float addend = (float)linear->addend * (float)linear->ratio.numerator;
    const float per = (float)linear->factor * (float)linear->ratio.numerator;
    const float steps = (scaled - addend) / per;
    /* The relative error of each of at most ten roundings is 2^-24 or less; 2^-20 is more than all of them. */
    const float error = (canwright_float_magnitude(scaled) + canwright_float_magnitude(addend)) *
        (1.0f / 1048576.0f / canwright_float_magnitude(per));
    float rest;
    if (!((steps > -1048576.0f) && (steps < 1048576.0f))) {
        return false;
    }
    *nearest = (int32_t)steps;
    rest = steps - (float)(int32_t)*nearest;
    if ((canwright_float_magnitude(rest) + error) < 0.5f) {
        return true;
    }
    *nearest += (rest < 0.0f) ? -1 : 1;
    return (canwright_float_magnitude(rest) - error) > 0.5f;
}

/** The raw integer nearest to a value, ties away from zero. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_signed_from_float(
    int64_t *nearest, float value, const canwright_linear_t *linear, int64_t lowest, int64_t highest)
{
    const uint32_t bits = canwright_bits_of_float(value);
    canwright_term_t term;
    if (!canwright_is_finite32(bits)) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (canwright_float_decides(nearest, value, linear)) {
        return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
    }
    canwright_term_single(&term, bits);
    return canwright_signed_from_term(nearest, &term, linear, lowest, highest);
}

/** The raw integer nearest to a value, ties away from zero. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_unsigned_from_float(
    uint64_t *nearest, float value, const canwright_linear_t *linear, uint64_t lowest, uint64_t highest)
{
    const uint32_t bits = canwright_bits_of_float(value);
    canwright_term_t term;
    int64_t decided;
    if (!canwright_is_finite32(bits)) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (canwright_float_decides(&decided, value, linear)) {
        *nearest = (uint64_t)decided;
        return ((decided >= 0) && (*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK
                                                                                 : CANWRIGHT_OUT_OF_RANGE;
    }
    canwright_term_single(&term, bits);
    return canwright_unsigned_from_term(nearest, &term, linear, lowest, highest);
}

/**
 * The value of an integer with a scale for which 64 bits are enough: the magnitudes of `factor` and `divisor` are less
 * than 2^31, that of `addend` is less than 2^37, the dividend of every raw integer fits in 64 bits, and there is no ratio.
 */
CANWRIGHT_NONNULL
static inline float canwright_narrow_to_float(int64_t raw, const canwright_linear_t *linear)
{
    const int64_t dividend = (raw * linear->factor) + linear->addend;
    uint64_t size = canwright_magnitude(dividend);
    const uint64_t divisor = (uint64_t)linear->divisor;
    uint32_t exponent = 127u;
    uint64_t sticky;
    float value;
    if (size == 0u) {
        return 0.0f;
    }
    for (; (size >> 61) == 0u; size <<= 1) {
        exponent--;
    }
    /* The quotient has at least 31 bits; the lowest one stands for the remainder. */
    sticky = (size / divisor) | (((size % divisor) != 0u) ? 1u : 0u);
    value = (float)sticky * canwright_float_of_bits(exponent << 23);
    return (dividend < 0) ? -value : value;
}

/**
 * The raw integer nearest to a value, ties away from zero, with such a scale; the dividends of twice the limits and of
 * the integers beside them fit in 64 bits.
 */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_narrow_from_float(
    int64_t *nearest, float value, const canwright_linear_t *linear, int64_t lowest, int64_t highest)
{
    const uint32_t bits = canwright_bits_of_float(value);
    const uint32_t biased = (bits >> 23) & 0xFFu;
    const int shift = 150 - ((biased == 0u) ? 1 : (int)biased); /* value = size * 2^-shift */
    const int kept = (shift < 0) ? 0 : ((shift > 24) ? 24 : shift);
    const int down = shift - kept;
    uint64_t size = (uint64_t)((biased == 0u) ? (bits & 0x7FFFFFu) : ((bits & 0x7FFFFFu) | 0x800000u));
    int64_t dividend;
    int64_t divisor = linear->factor * (INT64_C(1) << kept);
    if (!canwright_is_finite32(bits)) {
        return CANWRIGHT_NOT_FINITE;
    }
    size *= (uint64_t)linear->divisor;
    if (shift < 0) {
        const int up = -shift;
        if ((up > 62) || (size > (0x3FFFFFFFFFFFFFFFu >> (unsigned)up))) {
            return CANWRIGHT_OUT_OF_RANGE;
        }
        size <<= (unsigned)up;
    } else if (down > 55) { /* all bits of a product of 55 bits are too low; one of them stands for the rest */
        size = (size != 0u) ? UINT64_C(1) : UINT64_C(0);
    } else if (down > 0) {
        const uint64_t low = size & ((UINT64_C(1) << (unsigned)down) - 1u);
        size = (size >> (unsigned)down) | ((low != 0u) ? 1u : 0u);
    } else {
        /* The size is exact. */
    }
    dividend = (((bits >> 31) != 0u) ? -(int64_t)size : (int64_t)size) - (linear->addend * (INT64_C(1) << kept));
    if (divisor < 0) {
        divisor = -divisor;
        dividend = -dividend;
    }
    *nearest = canwright_divide64(dividend, divisor);
    return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The value of the 32-bit number that has these bits. */
CANWRIGHT_NONNULL
static inline float canwright_bits32_to_float(uint32_t bits, const canwright_linear_t *linear)
{
    canwright_term_t term;
    if (canwright_is_identity(linear) || !canwright_is_finite32(bits)) {
        return canwright_float_of_bits((linear->factor < 0) ? (bits ^ 0x80000000u) : bits);
    }
    canwright_term_single(&term, bits);
    return canwright_float_of_bits((uint32_t)canwright_value_bits(&term, linear, CANWRIGHT_SINGLE));
}

/** The value of the 64-bit number that has these bits. */
CANWRIGHT_NONNULL
static inline float canwright_bits64_to_float(uint64_t bits, const canwright_linear_t *linear)
{
    canwright_term_t term;
    if (!canwright_is_finite64(bits)) {
        const bool negative = (bits >> 63) != 0u;
        const bool reversed = linear->factor < 0;
        const uint32_t sign = (negative != reversed) ? 0x80000000u : 0u;
        return canwright_float_of_bits(sign | (((bits << 12) != 0u) ? 0x7FC00000u : 0x7F800000u));
    }
    canwright_term_double(&term, bits);
    return canwright_float_of_bits((uint32_t)canwright_value_bits(&term, linear, CANWRIGHT_SINGLE));
}

/** The bits of the 64-bit number nearest to the raw number of a value. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits64_from_float(
    uint64_t *bits, float value, const canwright_linear_t *linear)
{
    const uint32_t given = canwright_bits_of_float(value);
    canwright_term_t term;
    if (!canwright_is_finite32(given)) {
        return CANWRIGHT_NOT_FINITE;
    }
    canwright_term_single(&term, given);
    *bits = canwright_raw_bits(&term, linear, CANWRIGHT_DOUBLE);
    return canwright_is_finite64(*bits) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The bits of the 32-bit number nearest to a finite 64-bit number. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits32_of_bits64(uint32_t *bits, uint64_t wide)
{
    const canwright_linear_t identity = {1, 0, 1, {1, 1u}};
    canwright_term_t term;
    canwright_term_double(&term, wide);
    *bits = (uint32_t)canwright_raw_bits(&term, &identity, CANWRIGHT_SINGLE);
    return canwright_is_finite32(*bits) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The bits of the 32-bit number nearest to the raw number of a value, which is rounded to a 64-bit number first. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits32_from_float(
    uint32_t *bits, float value, const canwright_linear_t *linear)
{
    uint64_t wide;
    canwright_status_t status;
    if (canwright_is_identity(linear)) {
        *bits = canwright_bits_of_float(value);
        return canwright_is_finite32(*bits) ? CANWRIGHT_OK : CANWRIGHT_NOT_FINITE;
    }
    status = canwright_bits64_from_float(&wide, value, linear);
    return (status == CANWRIGHT_OK) ? canwright_bits32_of_bits64(bits, wide) : status;
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

/** The magnitude of a number. */
static inline double canwright_double_magnitude(double number)
{
    return (number < 0.0) ? -number : number;
}

/** The value of the integer of a sign and a magnitude. */
CANWRIGHT_NONNULL
static inline double canwright_integer_to_double(bool negative, uint64_t raw, const canwright_linear_t *linear)
{
    const double limit = 9007199254740992.0; /* integers up to this one are exact */
    const double factor = (double)linear->factor;
    const double addend = (double)linear->addend;
    const double numerator = (double)linear->ratio.numerator;
    const double below = (double)linear->divisor * (double)linear->ratio.denominator;
    const double size = (double)raw;
    const double most = ((size * canwright_double_magnitude(factor)) + canwright_double_magnitude(addend)) * numerator;
    canwright_term_t term;
    if ((most < limit) && (below < limit)) {
        return (((negative ? -size : size) * factor) + addend) * numerator / below;
    }
    canwright_term_integer(&term, raw, negative);
    return canwright_double_of_bits(canwright_value_bits(&term, linear, CANWRIGHT_DOUBLE));
}

/** The value of a signed integer. */
CANWRIGHT_NONNULL
static inline double canwright_signed_to_double(int64_t raw, const canwright_linear_t *linear)
{
    return canwright_integer_to_double(raw < 0, canwright_magnitude(raw), linear);
}

/** The value of an unsigned integer. */
CANWRIGHT_NONNULL
static inline double canwright_unsigned_to_double(uint64_t raw, const canwright_linear_t *linear)
{
    return canwright_integer_to_double(false, raw, linear);
}

/** The raw integer nearest to a value if the precision of a double is enough to decide which one this is; else false. */
CANWRIGHT_NONNULL
static inline bool canwright_double_decides(int64_t *nearest, double value, const canwright_linear_t *linear)
{
    const double scaled = value * ((double)linear->divisor * (double)linear->ratio.denominator);
    const double addend = (double)linear->addend * (double)linear->ratio.numerator;
    const double per = (double)linear->factor * (double)linear->ratio.numerator;
    const double steps = (scaled - addend) / per;
    /* The relative error of each of at most ten roundings is 2^-53 or less; 2^-49 is more than all of them. */
    const double error = (canwright_double_magnitude(scaled) + canwright_double_magnitude(addend)) *
        (1.0 / 562949953421312.0 / canwright_double_magnitude(per));
    double rest;
    if (!((steps > -1125899906842624.0) && (steps < 1125899906842624.0))) {
        return false;
    }
    *nearest = (int64_t)steps;
    rest = steps - (double)(int64_t)*nearest;
    if ((canwright_double_magnitude(rest) + error) < 0.5) {
        return true;
    }
    *nearest += (rest < 0.0) ? -1 : 1;
    return (canwright_double_magnitude(rest) - error) > 0.5;
}

/** The raw integer nearest to a value, ties away from zero. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_signed_from_double(
    int64_t *nearest, double value, const canwright_linear_t *linear, int64_t lowest, int64_t highest)
{
    const uint64_t bits = canwright_bits_of_double(value);
    canwright_term_t term;
    if (!canwright_is_finite64(bits)) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (canwright_double_decides(nearest, value, linear)) {
        return ((*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
    }
    canwright_term_double(&term, bits);
    return canwright_signed_from_term(nearest, &term, linear, lowest, highest);
}

/** The raw integer nearest to a value, ties away from zero. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_unsigned_from_double(
    uint64_t *nearest, double value, const canwright_linear_t *linear, uint64_t lowest, uint64_t highest)
{
    const uint64_t bits = canwright_bits_of_double(value);
    canwright_term_t term;
    int64_t decided;
    if (!canwright_is_finite64(bits)) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (canwright_double_decides(&decided, value, linear)) {
        *nearest = (uint64_t)decided;
        return ((decided >= 0) && (*nearest >= lowest) && (*nearest <= highest)) ? CANWRIGHT_OK
                                                                                 : CANWRIGHT_OUT_OF_RANGE;
    }
    canwright_term_double(&term, bits);
    return canwright_unsigned_from_term(nearest, &term, linear, lowest, highest);
}

/** The value of the 32-bit number that has these bits. */
CANWRIGHT_NONNULL
static inline double canwright_bits32_to_double(uint32_t bits, const canwright_linear_t *linear)
{
    canwright_term_t term;
    if (canwright_is_identity(linear) || !canwright_is_finite32(bits)) {
        return (double)canwright_float_of_bits((linear->factor < 0) ? (bits ^ 0x80000000u) : bits);
    }
    canwright_term_single(&term, bits);
    return canwright_double_of_bits(canwright_value_bits(&term, linear, CANWRIGHT_DOUBLE));
}

/** The value of the 64-bit number that has these bits. */
CANWRIGHT_NONNULL
static inline double canwright_bits64_to_double(uint64_t bits, const canwright_linear_t *linear)
{
    canwright_term_t term;
    if (canwright_is_identity(linear) || !canwright_is_finite64(bits)) {
        return canwright_double_of_bits((linear->factor < 0) ? (bits ^ 0x8000000000000000u) : bits);
    }
    canwright_term_double(&term, bits);
    return canwright_double_of_bits(canwright_value_bits(&term, linear, CANWRIGHT_DOUBLE));
}

/** The bits of the 64-bit number nearest to the raw number of a value. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits64_from_double(
    uint64_t *bits, double value, const canwright_linear_t *linear)
{
    canwright_term_t term;
    *bits = canwright_bits_of_double(value);
    if (!canwright_is_finite64(*bits)) {
        return CANWRIGHT_NOT_FINITE;
    }
    if (!canwright_is_identity(linear)) {
        canwright_term_double(&term, *bits);
        *bits = canwright_raw_bits(&term, linear, CANWRIGHT_DOUBLE);
    }
    return canwright_is_finite64(*bits) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The bits of the 32-bit number nearest to the raw number of a value, which is rounded to a 64-bit number first. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_bits32_from_double(
    uint32_t *bits, double value, const canwright_linear_t *linear)
{
    /* Halfway from the greatest 32-bit number to the next one if there were more exponents. */
    const double limit = 3.4028235677973366e+38;
    uint64_t wide;
    const canwright_status_t status = canwright_bits64_from_double(&wide, value, linear);
    const double number = canwright_double_of_bits(wide);
    if (status != CANWRIGHT_OK) {
        return status;
    }
    if (!((number > -limit) && (number < limit))) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    *bits = canwright_bits_of_float((float)number);
    return CANWRIGHT_OK;
}

#endif

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
