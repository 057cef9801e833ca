/**
 * @file
 * What the self-tests of all editions share: the result, and the tables of golden frames. Nothing here depends on a
 * protocol.
 */
#ifndef CANWRIGHT_SELFTEST_H
#define CANWRIGHT_SELFTEST_H

#include "canwright.h"

#if defined(__AVR__)
#include <avr/pgmspace.h>
/** Places a table in flash. Constants are in RAM otherwise, as an AVR has separate addresses for flash. */
#define CANWRIGHT_FLASH PROGMEM
/** One byte of a table in flash. */
#define CANWRIGHT_FLASH_BYTE(address) pgm_read_byte(address)
#else
/** Places a table in flash; the compiler places constants there. */
#define CANWRIGHT_FLASH
/** One byte of a table in flash. */
#define CANWRIGHT_FLASH_BYTE(address) (*(address))
#endif

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wzero-as-null-pointer-constant"
#endif

/** What a golden frame shows to be wrong. */
typedef enum {
    CANWRIGHT_STEP_NONE = 0,
    /** The function that decodes the message rejects the frame. */
    CANWRIGHT_STEP_DECODE,
    /** It returns another node or other raw integers. */
    CANWRIGHT_STEP_FIELDS,
    /** The function that decodes any frame rejects it, or returns another command, node or raw integer. */
    CANWRIGHT_STEP_DECODE_ANY,
    /** The function that encodes the message rejects the raw integers, or writes another frame. */
    CANWRIGHT_STEP_ENCODE,
    /** An invalid frame is not rejected for the expected reason. */
    CANWRIGHT_STEP_REJECT_FRAME,
    /** An invalid message is not rejected for the expected reason, or for another field. */
    CANWRIGHT_STEP_REJECT_MESSAGE,
    /** A frame is a reply to a request, or is not, against expectation. */
    CANWRIGHT_STEP_REPLY
} canwright_step_t;

/** What a step means, as a text. */
static inline const char *canwright_step_text(canwright_step_t step)
{
    switch ((int)step) {
    case CANWRIGHT_STEP_DECODE:
        return "the frame is rejected";
    case CANWRIGHT_STEP_FIELDS:
        return "another node or other raw integers";
    case CANWRIGHT_STEP_DECODE_ANY:
        return "decoded by itself, the frame is another one";
    case CANWRIGHT_STEP_ENCODE:
        return "the raw integers are rejected, or encoded as another frame";
    case CANWRIGHT_STEP_REJECT_FRAME:
        return "not rejected for the expected reason";
    case CANWRIGHT_STEP_REJECT_MESSAGE:
        return "not rejected for the expected reason, or for another field";
    case CANWRIGHT_STEP_REPLY:
        return "a reply is not accepted, or another frame is";
    default:
        return "";
    }
}

/** The kind of a case. */
typedef enum {
    /** Added for a golden frame that no other message has. */
    CANWRIGHT_CASE_UNIQUE = 1,
    /** Added for a golden frame that an encoder writes exactly so. */
    CANWRIGHT_CASE_ENCODED = 2,
    /** A request that must be rejected. */
    CANWRIGHT_CASE_REQUEST = 4,
    /** A reply that must be rejected. */
    CANWRIGHT_CASE_REPLY,
    /** A message that must be rejected; there is no frame. */
    CANWRIGHT_CASE_MESSAGE,
    /** The request before the next case. */
    CANWRIGHT_CASE_ASKED,
    /** A reply to this request, or a frame that is none. */
    CANWRIGHT_CASE_ANSWER
} canwright_kind_t;

/** A message. */
typedef struct {
    /** Its command. */
    uint32_t command;
    /** The table of its raw integers; 0 without fields. */
    uint16_t layout;
    /** True for a reply. */
    bool is_reply;
} canwright_golden_message_t;

/** Fills a result, so that a function that does not write all of it is noticed. */
CANWRIGHT_NONNULL
static inline void canwright_spoil(void *result, size_t size)
{
    size_t i;
    for (i = 0u; i < size; i++) {
        ((uint8_t *)result)[i] = 0xA5u;
    }
}

/** Copies an entry of a table in flash. */
CANWRIGHT_NONNULL
static inline void canwright_flash_read(void *entry, const void *table, size_t index, size_t size)
{
    const uint8_t *from = (const uint8_t *)table + index * size;
    uint8_t *to = (uint8_t *)entry;
    size_t i;
    for (i = 0u; i < size; i++) {
        to[i] = CANWRIGHT_FLASH_BYTE(from + i);
    }
}

/* From here on, everything contains frames. */

/** The result of a self-test. Cases are numbered from 1, in the order of the comments in its tables. */
typedef struct {
    /** Number of cases. */
    uint16_t cases;
    /** Number of cases that failed. */
    uint16_t failures;
    /** The first case that failed; 0 if none did. */
    uint16_t first;
    /** What failed in it. */
    canwright_step_t step;
    /** Its frame; for CANWRIGHT_STEP_REJECT_MESSAGE, the frame that was written. */
    canwright_frame_t frame;
} canwright_selftest_t;

/** A frame as it is stored. */
typedef struct {
    /** The id with its flags. */
    uint32_t id;
    /** The data bytes, four in a number: the first is the highest. */
    uint32_t data[CANWRIGHT_MAX_DATA / 4u];
} canwright_stored_t;

/** A case: the numbers are indices of tables. */
typedef struct {
    /** The frame. */
    canwright_stored_t frame;
    /** The node; 0 without nodes. */
    uint32_t node;
    /** The message. */
    uint16_t message;
    /** The raw integers of its fields. */
    uint16_t raws;
    /** The field that must be rejected; 0 for any. */
    uint16_t field;
    /** The parameters of the node. */
    uint8_t parameters;
    /** Number of data bytes. */
    uint8_t dlc;
    /** A canwright_kind_t. */
    uint8_t kind;
    /** The expected canwright_status_t. */
    uint8_t status;
} canwright_case_t;

/** A stored frame as the functions take it. */
CANWRIGHT_NONNULL
static inline void canwright_restore(canwright_frame_t *frame, const canwright_stored_t *stored, uint8_t dlc)
{
    size_t i;
    canwright_clear(frame);
    frame->id = stored->id;
    frame->dlc = dlc;
    for (i = 0u; i < CANWRIGHT_MAX_DATA; i++) {
        frame->data[i] = (uint8_t)(stored->data[i / 4u] >> (24u - (8u * (i % 4u))));
    }
}

/** True for equal frames; the data of a remote frame, which has none, are not compared. */
CANWRIGHT_NONNULL
static inline bool canwright_same_frame(const canwright_frame_t *one, const canwright_frame_t *other)
{
    return one->id == other->id && ((one->id & CANWRIGHT_REMOTE) != 0u || canwright_same_data(one, other));
}

/** Counts a case. */
CANWRIGHT_NONNULL
static inline void canwright_selftest_count(
    canwright_selftest_t *result, canwright_step_t step, const canwright_frame_t *frame)
{
    result->cases++;
    if (step != CANWRIGHT_STEP_NONE) {
        result->failures++;
        if (result->first == 0u) {
            result->first = result->cases;
            result->step = step;
            result->frame = *frame;
        }
    }
}

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
