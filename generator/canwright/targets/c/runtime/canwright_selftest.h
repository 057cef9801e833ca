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

/** Set for a frame that no other message has. */
#define CANWRIGHT_GOLDEN_UNIQUE 1u

/** Set for a frame that an encoder writes exactly so. */
#define CANWRIGHT_GOLDEN_ENCODED 2u

/** A message that must be rejected. */
typedef struct {
    /** The node. */
    uint32_t node;
    /** The message. */
    uint16_t message;
    /** The raw integers of its fields. */
    uint16_t raws;
    /** The field that must be named; 0 for any. */
    uint16_t field;
    /** The parameters of the node. */
    uint8_t parameters;
    /** The reason, a canwright_status_t. */
    uint8_t status;
} canwright_golden_refusal_t;

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
    /** The data bytes. */
    uint8_t data[CANWRIGHT_MAX_DATA];
} canwright_stored_t;

/** A golden frame: the numbers are indices of tables. */
typedef struct {
    /** The frame. */
    canwright_stored_t frame;
    /** The node; 0 without nodes. */
    uint32_t node;
    /** The message. */
    uint16_t message;
    /** The raw integers of its fields. */
    uint16_t raws;
    /** The parameters of the node. */
    uint8_t parameters;
    /** Number of data bytes. */
    uint8_t dlc;
    /** CANWRIGHT_GOLDEN_UNIQUE, CANWRIGHT_GOLDEN_ENCODED. */
    uint8_t flags;
} canwright_golden_t;

/** A frame that must be rejected. */
typedef struct {
    /** The frame. */
    canwright_stored_t frame;
    /** Number of data bytes. */
    uint8_t dlc;
    /** The parameters of the node. */
    uint8_t parameters;
    /** 1 for a request, 0 for a reply. */
    uint8_t is_request;
    /** The reason, a canwright_status_t. */
    uint8_t status;
} canwright_golden_rejection_t;

/** A request and a later frame. */
typedef struct {
    /** The request. */
    canwright_stored_t request;
    /** The later frame. */
    canwright_stored_t reply;
    /** Number of data bytes of the request. */
    uint8_t request_dlc;
    /** Number of data bytes of the later frame. */
    uint8_t reply_dlc;
    /** The parameters of the node, if the check needs them. */
    uint8_t parameters;
    /** CANWRIGHT_OK if the frame is a reply, else the reason. */
    uint8_t status;
} canwright_golden_exchange_t;

/** A stored frame as the functions take it. */
CANWRIGHT_NONNULL
static inline void canwright_restore(canwright_frame_t *frame, const canwright_stored_t *stored, uint8_t dlc)
{
    size_t i;
    canwright_clear(frame);
    frame->id = stored->id;
    frame->dlc = dlc;
    for (i = 0u; i < CANWRIGHT_MAX_DATA; i++) {
        frame->data[i] = stored->data[i];
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
