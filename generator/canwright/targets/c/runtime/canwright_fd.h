/**
 * @file
 * The frame of CAN FD, for editions whose bus has it.
 */
#ifndef CANWRIGHT_FD_H
#define CANWRIGHT_FD_H

#include "canwright.h"

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#endif

/** The most data bytes of a frame of CAN FD. */
#define CANWRIGHT_FD_MAX_DATA 64u

/** Set in the flags of a frame whose data are sent with the higher bit rate. */
#define CANWRIGHT_FD_BRS 0x01u

/** Set in the flags of a frame of CAN FD. */
#define CANWRIGHT_FD_FDF 0x04u

/**
 * A frame of CAN FD or of classic CAN with the layout of SocketCAN's `struct canfd_frame`: 72 bytes, the data at offset 8.
 * The id and its flag are those of `can_id`. Decoding ignores the flags, because a receiver of CAN FD accepts both formats.
 */
typedef struct {
    /** 11 bits, or 29 and CANWRIGHT_EXTENDED. */
    uint32_t id;
    /** Number of data bytes, as CAN FD permits them, not the code of a length. */
    uint8_t dlc;
    /** CANWRIGHT_FD_FDF and CANWRIGHT_FD_BRS. */
    uint8_t flags;
    /** Encoded as 0, and ignored. */
    uint8_t reserved[2];
    /** The data bytes; only the first `dlc` are used. */
    CANWRIGHT_ALIGNED uint8_t data[CANWRIGHT_FD_MAX_DATA];
} canwright_fd_frame_t;

/** Sets all data bytes, the flags and the reserved bytes to 0. */
CANWRIGHT_NONNULL
static inline void canwright_fd_clear(canwright_fd_frame_t *frame)
{
    uint8_t i;
    frame->flags = 0u;
    frame->reserved[0] = 0u;
    frame->reserved[1] = 0u;
    for (i = 0u; i < CANWRIGHT_FD_MAX_DATA; i++) {
        frame->data[i] = 0u;
    }
}

/** True for a frame that a filter accepts. */
CANWRIGHT_NONNULL
static inline bool canwright_fd_accepts(const canwright_filter_t *filter, const canwright_fd_frame_t *frame)
{
    return (frame->id & filter->mask) == (filter->id & filter->mask);
}

/** True for two frames with the same data bytes. */
CANWRIGHT_NONNULL
static inline bool canwright_fd_same_data(const canwright_fd_frame_t *one, const canwright_fd_frame_t *other)
{
    uint8_t i;
    if (one->dlc != other->dlc) {
        return false;
    }
    for (i = 0u; (i < one->dlc) && (i < CANWRIGHT_FD_MAX_DATA); i++) {
        if (one->data[i] != other->data[i]) {
            return false;
        }
    }
    return true;
}

#if defined(__cplusplus) && defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#endif
