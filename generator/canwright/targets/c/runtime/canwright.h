/**
 * @file
 * What all editions share: the frame, the status and exact arithmetic. Nothing here depends on a protocol.
 */
#ifndef CANWRIGHT_H
#define CANWRIGHT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wzero-as-null-pointer-constant"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wuseless-cast"
#endif
#endif

/** The version of this file. Headers that need another version do not compile. */
#define CANWRIGHT_H_VERSION 9

/** Marks a function whose result must be used; define it before, also as empty, to replace it. */
#ifndef CANWRIGHT_CHECKED
#if (defined(__cplusplus) && __cplusplus >= 201703L) || (defined(__STDC_VERSION__) && __STDC_VERSION__ >= 202311L)
#define CANWRIGHT_CHECKED [[nodiscard]]
#elif defined(__GNUC__)
#define CANWRIGHT_CHECKED __attribute__((warn_unused_result))
#else
#define CANWRIGHT_CHECKED
#endif
#endif

/** Marks a function none of whose pointers may be NULL; define it before, also as empty, to replace it. */
#ifndef CANWRIGHT_NONNULL
#if defined(__GNUC__)
#define CANWRIGHT_NONNULL __attribute__((nonnull))
#else
#define CANWRIGHT_NONNULL
#endif
#endif

/**
 * Marks a frame that overlaps nothing else that a function gets, so that clang writes it in fewer instructions; GCC would not.
 * Define it before, also as empty, to replace it.
 */
#ifndef CANWRIGHT_RESTRICT
#if defined(__clang__)
#define CANWRIGHT_RESTRICT __restrict
#else
#define CANWRIGHT_RESTRICT
#endif
#endif

#ifdef __cplusplus
/** Initializes a message or parameters: `= CANWRIGHT_ZERO`. A member that is not assigned is 0 then. */
#define CANWRIGHT_ZERO {}
#else
/** Initializes a message or parameters: `= CANWRIGHT_ZERO`. A member that is not assigned is 0 then. */
#define CANWRIGHT_ZERO {0}
#endif

/** The alignment of a frame, where a compiler has a syntax for it in every standard and the target aligns anything so. */
#if defined(__BIGGEST_ALIGNMENT__) && __BIGGEST_ALIGNMENT__ >= 8
#define CANWRIGHT_ALIGNED __attribute__((aligned(8)))
#else
#define CANWRIGHT_ALIGNED
#endif

/** The most data bytes of a frame of classic CAN. */
#define CANWRIGHT_MAX_DATA 8u

/** Set in an id of 29 bits. */
#define CANWRIGHT_EXTENDED 0x80000000u

/** Set in the id of a remote frame. */
#define CANWRIGHT_REMOTE 0x40000000u

/**
 * A classic CAN frame with the layout of SocketCAN's `struct can_frame`: 16 bytes, the data at offset 8. The id and its
 * two flags are those of `can_id`, so an extended or a remote frame never equals a standard data frame. A compiler can
 * combine accesses to the data bytes, because they are aligned.
 */
typedef struct {
    /** 11 bits, or 29 and CANWRIGHT_EXTENDED; with CANWRIGHT_REMOTE for a remote frame. */
    uint32_t id;
    /** Number of data bytes, 0 to CANWRIGHT_MAX_DATA. */
    uint8_t dlc;
    /** Encoded as 0, and ignored. */
    uint8_t reserved[3];
    /** The data bytes; only the first `dlc` are used. */
    CANWRIGHT_ALIGNED uint8_t data[CANWRIGHT_MAX_DATA];
} canwright_frame_t;

/**
 * An acceptance filter with the layout of SocketCAN's `struct can_filter`. A frame passes if
 * `(frame.id & mask) == (filter.id & mask)`; the flags of the id are part of both. The mask has every bit that all
 * wanted ids have in common, so no other single filter accepts fewer frames.
 */
typedef struct {
    /** The bits that an id must have. */
    uint32_t id;
    /** The bits that are compared. */
    uint32_t mask;
} canwright_filter_t;

/** The result of a call. Unless it is CANWRIGHT_OK, the outputs are unspecified. */
typedef enum {
    CANWRIGHT_OK = 0,
    /** No message of this direction has this id in this frame format. */
    CANWRIGHT_UNKNOWN_ID,
    /** The id is known, but no message with this id has this code. */
    CANWRIGHT_UNKNOWN_CODE,
    /** The message has a different DLC. */
    CANWRIGHT_WRONG_LENGTH,
    /** A constant field has a different value. */
    CANWRIGHT_WRONG_CONSTANT,
    /** The result depends on a parameter that is unknown. */
    CANWRIGHT_MISSING_PARAMETER,
    /** The raw integer has no scale, so it cannot be converted to a value. */
    CANWRIGHT_NO_SCALE,
    /** The value exceeds the range or the bits of the type or has no name, or an absent field is not 0. */
    CANWRIGHT_OUT_OF_RANGE,
    /** The value is NaN or infinity. */
    CANWRIGHT_NOT_FINITE,
    /** The address does not have this node. */
    CANWRIGHT_UNKNOWN_NODE,
    /** The reply does not belong to the request. */
    CANWRIGHT_NOT_ANSWER,
    /** A node with these parameters does not have this command, or this field. */
    CANWRIGHT_NOT_AVAILABLE,
    /** The checksum is not that of the frame. */
    CANWRIGHT_WRONG_CHECKSUM,
    /** The raw integer means that there is no value, such as "not available"; `*_no_value` has its name. */
    CANWRIGHT_NO_VALUE,
    /** Receivers identify a frame with these values as another message. */
    CANWRIGHT_WRONG_MESSAGE
} canwright_status_t;

/** A number as a quotient, exact without floating point: 6 is {6, 1}. A denominator of 0 means unknown. */
typedef struct {
    /** Negative for a negative number. */
    int32_t numerator;
    /** 0 for an unknown number. */
    uint32_t denominator;
} canwright_ratio_t;

/** A 32-bit IEEE 754 number as its bits. It is a struct, so that no number converts to it: a conversion of its type sets it. */
typedef struct {
    /** The bits on the wire. */
    uint32_t bits;
} canwright_float32_t;

/** A 64-bit IEEE 754 number as its bits. */
typedef struct {
    /** The bits on the wire. */
    uint64_t bits;
} canwright_float64_t;

/** The name of a status. */
static inline const char *canwright_status_name(canwright_status_t status)
{
    switch ((int)status) {
    case CANWRIGHT_OK:
        return "ok";
    case CANWRIGHT_UNKNOWN_ID:
        return "unknown_id";
    case CANWRIGHT_UNKNOWN_CODE:
        return "unknown_code";
    case CANWRIGHT_WRONG_LENGTH:
        return "wrong_length";
    case CANWRIGHT_WRONG_CONSTANT:
        return "wrong_constant";
    case CANWRIGHT_MISSING_PARAMETER:
        return "missing_parameter";
    case CANWRIGHT_NO_SCALE:
        return "no_scale";
    case CANWRIGHT_OUT_OF_RANGE:
        return "out_of_range";
    case CANWRIGHT_NOT_FINITE:
        return "not_finite";
    case CANWRIGHT_UNKNOWN_NODE:
        return "unknown_node";
    case CANWRIGHT_NOT_ANSWER:
        return "not_answer";
    case CANWRIGHT_NOT_AVAILABLE:
        return "not_available";
    case CANWRIGHT_WRONG_CHECKSUM:
        return "wrong_checksum";
    case CANWRIGHT_NO_VALUE:
        return "no_value";
    case CANWRIGHT_WRONG_MESSAGE:
        return "wrong_message";
    default:
        return "?";
    }
}

/** Sets all data bytes and the reserved bytes to 0. */
CANWRIGHT_NONNULL
static inline void canwright_clear(canwright_frame_t *frame)
{
    /* One by one: a loop may become a call of memset. */
    frame->reserved[0] = 0u;
    frame->reserved[1] = 0u;
    frame->reserved[2] = 0u;
    frame->data[0] = 0u;
    frame->data[1] = 0u;
    frame->data[2] = 0u;
    frame->data[3] = 0u;
    frame->data[4] = 0u;
    frame->data[5] = 0u;
    frame->data[6] = 0u;
    frame->data[7] = 0u;
}

/** True for a frame that a filter accepts. */
CANWRIGHT_NONNULL
static inline bool canwright_accepts(const canwright_filter_t *filter, const canwright_frame_t *frame)
{
    return (frame->id & filter->mask) == (filter->id & filter->mask);
}

/** True for two frames with the same data bytes. */
CANWRIGHT_NONNULL
static inline bool canwright_same_data(const canwright_frame_t *one, const canwright_frame_t *other)
{
    uint8_t i;
    if (one->dlc != other->dlc) {
        return false;
    }
    for (i = 0u; (i < one->dlc) && (i < CANWRIGHT_MAX_DATA); i++) {
        if (one->data[i] != other->data[i]) {
            return false;
        }
    }
    return true;
}

/* The two alternatives are the same bits, so that compilers leave the comparison out. */

/** The signed number in 8 bits. */
static inline int8_t canwright_signed8(uint8_t raw)
{
    return (raw <= 0x7Fu) ? (int8_t)raw : (int8_t)((int32_t)raw - 0x100);
}

/** The signed number in 16 bits. */
static inline int16_t canwright_signed16(uint16_t raw)
{
    return (raw <= 0x7FFFu) ? (int16_t)raw : (int16_t)((int32_t)raw - 0x10000);
}

/** The signed number in the lowest `width` bits, 1 to 32; the bits above them are 0. */
static inline int32_t canwright_signed32(uint32_t raw, unsigned width)
{
    const uint32_t sign = UINT32_C(1) << (width - 1u);
    const uint32_t above = raw ^ sign;
    return (int32_t)((int64_t)above - (int64_t)sign); /* In one expression, GCC computes it with 32 bits. */
}

/** The signed number in the lowest `width` bits, 33 to 64; the bits above them are 0. */
static inline int64_t canwright_signed64(uint64_t raw, unsigned width)
{
    const uint64_t sign = UINT64_C(1) << (width - 1u);
    const uint64_t above = raw ^ sign;
    const uint64_t below = UINT64_MAX - raw;
    if (width == 64u) {
        return (raw < sign) ? (int64_t)raw : (-(int64_t)below - 1);
    }
    return (int64_t)above - (int64_t)sign;
}

/** The signed number of 64 bits in two words, which takes fewer instructions than shifts of 64 bits. */
static inline int64_t canwright_signed_words(uint32_t high, uint32_t low)
{
    const uint64_t raw = ((uint64_t)high << 32) | low;
    const uint64_t below = UINT64_MAX - raw;
    return (raw <= (uint64_t)INT64_MAX) ? (int64_t)raw : (-(int64_t)below - 1);
}

/**
 * The quotient nearest to `dividend / divisor`, ties away from zero. `divisor` is positive, and the magnitude of
 * `dividend` plus half of it must not overflow.
 */
static inline int32_t canwright_divide32(int32_t dividend, int32_t divisor)
{
    return ((dividend < 0) ? (dividend - (divisor / 2)) : (dividend + (divisor / 2))) / divisor;
}

/**
 * The quotient nearest to `dividend / divisor`, ties away from zero. `divisor` is positive, and the magnitude of
 * `dividend` plus half of it must not overflow.
 */
static inline int64_t canwright_divide64(int64_t dividend, int64_t divisor)
{
    return ((dividend < 0) ? (dividend - (divisor / 2)) : (dividend + (divisor / 2))) / divisor;
}

/** Whether a parameter that ids or constants contain is a whole number from `lowest` to `highest`. */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline canwright_status_t canwright_check_whole(const canwright_ratio_t *number, int32_t lowest, int32_t highest)
{
    int32_t whole;
    if (number->denominator == 0u) {
        return CANWRIGHT_MISSING_PARAMETER;
    }
    if ((number->numerator < 0) || (((uint32_t)number->numerator % number->denominator) != 0u)) {
        return CANWRIGHT_OUT_OF_RANGE;
    }
    whole = (int32_t)((uint32_t)number->numerator / number->denominator);
    return ((whole >= lowest) && (whole <= highest)) ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
}

/** The value of such a parameter. */
CANWRIGHT_NONNULL
static inline uint32_t canwright_whole(const canwright_ratio_t *number)
{
    return (uint32_t)number->numerator / number->denominator;
}

/** The largest number that divides both; `second` if `first` is 0. */
static inline uint64_t canwright_common_divisor(uint64_t first, uint64_t second)
{
    while (first != 0u) {
        const uint64_t rest = second % first;
        second = first;
        first = rest;
    }
    return second;
}

/**
 * Computes `first * second / divisor` of parameters, each of which may be NULL. The denominator is 0 if one is unknown,
 * and the numerator is 0 if one is not above 0, or if the result does not fit.
 */
static inline void canwright_factor(
    canwright_ratio_t *result, const canwright_ratio_t *first, const canwright_ratio_t *second,
    const canwright_ratio_t *divisor)
{
    const canwright_ratio_t *const parameters[3] = {first, second, divisor};
    unsigned i;
    result->numerator = 1;
    result->denominator = 1u;
    for (i = 0u; i < 3u; i++) {
        if ((parameters[i] != NULL) && (parameters[i]->denominator == 0u)) {
            result->denominator = 0u;
            return;
        }
    }
    for (i = 0u; i < 3u; i++) {
        uint64_t above;
        uint64_t below;
        uint64_t common;
        if (parameters[i] == NULL) {
            continue;
        }
        if ((parameters[i]->numerator <= 0) || (result->numerator <= 0)) {
            result->numerator = 0;
            return;
        }
        above = (i < 2u) ? (uint64_t)parameters[i]->numerator : (uint64_t)parameters[i]->denominator;
        below = (i < 2u) ? (uint64_t)parameters[i]->denominator : (uint64_t)parameters[i]->numerator;
        above *= (uint64_t)result->numerator;
        below *= (uint64_t)result->denominator;
        common = canwright_common_divisor(above, below);
        above /= common;
        below /= common;
        result->numerator = ((above <= 0x7FFFFFFFu) && (below <= 0xFFFFFFFFu)) ? (int32_t)above : 0;
        result->denominator = (result->numerator != 0) ? (uint32_t)below : 1u;
    }
}

/** The integer nearest to `ratio * dividend / divisor`, ties away from zero; both products must fit in 64 bits. */
CANWRIGHT_NONNULL
static inline int64_t canwright_multiple64(const canwright_ratio_t *ratio, int64_t dividend, int64_t divisor)
{
    const int64_t above = dividend * (int64_t)ratio->numerator;
    const int64_t below = divisor * (int64_t)ratio->denominator;
    return canwright_divide64(above, below);
}

/** The largest integer not above `(factor * ratio + addend) / divisor`; `ratio` is known and `divisor` positive. */
CANWRIGHT_NONNULL
static inline int64_t canwright_floor(const canwright_ratio_t *ratio, int64_t factor, int64_t addend, int64_t divisor)
{
    const int64_t above = (factor * (int64_t)ratio->numerator) + (addend * (int64_t)ratio->denominator);
    const int64_t below = divisor * (int64_t)ratio->denominator;
    return (above / below) - (((above % below) < 0) ? 1 : 0);
}

/** The smallest integer not below `(factor * ratio + addend) / divisor`; `ratio` is known and `divisor` positive. */
CANWRIGHT_NONNULL
static inline int64_t canwright_ceiling(const canwright_ratio_t *ratio, int64_t factor, int64_t addend, int64_t divisor)
{
    return -canwright_floor(ratio, -factor, -addend, divisor);
}

/**
 * The integer nearest to `(share / ratio * divisor - addend) / factor`, ties away from zero; false if it is not
 * from `lowest` to `highest`, or if `share / ratio` exceeds `most`. `ratio` and `factor` are above 0.
 */
CANWRIGHT_CHECKED CANWRIGHT_NONNULL
static inline bool canwright_share64(int64_t *nearest, const canwright_ratio_t *ratio, int64_t share, int64_t most,
    int64_t divisor, int64_t addend, int64_t factor, int64_t lowest, int64_t highest)
{
    const int64_t limit = canwright_floor(ratio, most, 0, 1);
    const int64_t numerator = ratio->numerator;
    const int64_t denominator = ratio->denominator;
    if ((share < -limit) || (share > limit)) {
        return false;
    }
    *nearest = canwright_divide64((share * divisor * denominator) - (addend * numerator), factor * numerator);
    return (*nearest >= lowest) && (*nearest <= highest);
}

/** The value of a counter after `counter`: `first` after `last`, and after a value outside of both. */
static inline uint32_t canwright_counter_next(uint32_t counter, uint32_t first, uint32_t last)
{
    return ((counter >= first) && (counter < last)) ? (counter + 1u) : first;
}

/** So many increments lead from `previous` to `counter`; 0 if they are equal, or if one of them is outside of its range. */
static inline uint32_t canwright_counter_steps(uint32_t previous, uint32_t counter, uint32_t first, uint32_t last)
{
    if ((previous < first) || (previous > last) || (counter < first) || (counter > last)) {
        return 0u;
    }
    return (counter >= previous) ? (counter - previous) : ((last - previous) + (counter - first) + 1u);
}

/** A CRC register of `width` bits, 8 to 32, after one more byte that enters with its highest bit first. */
static inline uint32_t canwright_crc(uint32_t crc, uint8_t byte, uint32_t poly, unsigned width)
{
    const uint32_t top = UINT32_C(1) << (width - 1u);
    uint32_t next = crc ^ ((uint32_t)byte << (width - 8u));
    unsigned bit;
    for (bit = 0u; bit < 8u; bit++) {
        next = (next << 1) ^ (((next & top) != 0u) ? poly : 0u);
    }
    return next & (top | (top - 1u));
}

/** A CRC register after one more byte that enters with its lowest bit first; so is the polynomial. */
static inline uint32_t canwright_crc_reflected(uint32_t crc, uint8_t byte, uint32_t poly)
{
    uint32_t next = crc ^ byte;
    unsigned bit;
    for (bit = 0u; bit < 8u; bit++) {
        next = (next >> 1) ^ (((next & 1u) != 0u) ? poly : 0u);
    }
    return next;
}

/** True for the bits of a 32-bit IEEE 754 number that is neither infinity nor NaN. */
static inline bool canwright_is_finite32(uint32_t bits)
{
    return (bits & 0x7F800000u) != 0x7F800000u;
}

/** True for the bits of a 64-bit IEEE 754 number that is neither infinity nor NaN. */
static inline bool canwright_is_finite64(uint64_t bits)
{
    return (bits & 0x7FF0000000000000u) != 0x7FF0000000000000u;
}

/** The bits of a 32-bit IEEE 754 number as an integer that sorts like the number. */
static inline uint32_t canwright_order32(uint32_t bits)
{
    return ((bits >> 31) != 0u) ? ~bits : (bits | 0x80000000u);
}

/** The bits of a 64-bit IEEE 754 number as an integer that sorts like the number. */
static inline uint64_t canwright_order64(uint64_t bits)
{
    return ((bits >> 63) != 0u) ? ~bits : (bits | 0x8000000000000000u);
}

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
