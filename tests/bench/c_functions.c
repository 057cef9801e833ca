/*
 * One function at a time, as generated or as written by hand; `CASE` names it, and 0 is all. By hand, the checks are the
 * same: id, length and code, the parameters that a field or a scale depends on, and the range of what is sent; every byte of a frame is set.
 */
#include <mwd_motor/v2_35.h>

#define WANTED(number) (CASE == 0 || CASE == (number))

#ifndef BY_HAND

#define P(name) mwd_motor_v2_35_##name

#if WANTED(1)
canwright_status_t encode_set_torque(canwright_frame_t *frame, uint32_t node, const P(set_torque_request_t) * message,
    const P(parameters_t) * parameters)
{
    return P(set_torque_request_encode)(frame, node, message, parameters);
}
#endif

#if WANTED(2)
canwright_status_t encode_set_speed(canwright_frame_t *frame, uint32_t node, const P(set_speed_request_t) * message)
{
    return P(set_speed_request_encode)(frame, node, message);
}
#endif

#if WANTED(3)
canwright_status_t decode_set_torque_reply(
    P(motion_feedback_t) * message, uint32_t *node, const canwright_frame_t *frame, const P(parameters_t) * parameters)
{
    return P(set_torque_reply_decode)(message, node, frame, parameters);
}
#endif

#if WANTED(4)
canwright_status_t decode_multi_turn_angle(
    P(read_multi_turn_angle_reply_t) * message, uint32_t *node, const canwright_frame_t *frame)
{
    return P(read_multi_turn_angle_reply_decode)(message, node, frame);
}
#endif

#if WANTED(5)
canwright_status_t decode_status_1(P(status_1_t) * message, uint32_t *node, const canwright_frame_t *frame)
{
    return P(read_status_1_reply_decode)(message, node, frame);
}
#endif

#if WANTED(7)
canwright_status_t decode_status_3(
    P(read_status_3_reply_t) * message, uint32_t *node, const canwright_frame_t *frame)
{
    return P(read_status_3_reply_decode)(message, node, frame);
}
#endif

#if WANTED(6)
canwright_status_t milliamperes(int32_t *milli, int16_t raw, const P(parameters_t) * parameters)
{
    return P(torque_current_to_milli)(milli, raw, parameters);
}
#endif

#else

enum { OK, UNKNOWN_ID, UNKNOWN_CODE, WRONG_LENGTH, OUT_OF_RANGE, UNKNOWN_NODE, NO_SCALE, MISSING_PARAMETER, NOT_AVAILABLE };
enum series { UNKNOWN, MS, MF, MH, MG };

struct torque {
    int16_t iq;
};

struct speed {
    int32_t speed;
};

struct feedback {
    int8_t temperature;
    int16_t power;
    int16_t iq;
    int16_t speed;
    uint16_t encoder;
};

struct angle {
    int64_t angle;
};

struct status {
    int8_t temperature;
    uint16_t voltage;
    uint8_t errors;
};

struct phases {
    int8_t temperature;
    int16_t a;
    int16_t b;
    int16_t c;
};

struct known {
    enum series series;
};

#if WANTED(1)
int encode_set_torque(
    canwright_frame_t *frame, uint32_t node, const struct torque *message, const struct known *parameters)
{
    const int16_t iq = message->iq;
    if (parameters->series == MS) {
        return NOT_AVAILABLE;
    }
    if (iq < -2048 || iq > 2048) {
        return OUT_OF_RANGE;
    }
    if (node < 1 || node > 32) {
        return UNKNOWN_NODE;
    }
    frame->id = 0x140 + node;
    frame->dlc = 8;
    frame->reserved[0] = 0;
    frame->reserved[1] = 0;
    frame->reserved[2] = 0;
    frame->data[0] = 0xA1;
    frame->data[1] = 0;
    frame->data[2] = 0;
    frame->data[3] = 0;
    frame->data[4] = (uint8_t)iq;
    frame->data[5] = (uint8_t)((uint16_t)iq >> 8);
    frame->data[6] = 0;
    frame->data[7] = 0;
    return OK;
}
#endif

#if WANTED(2)
int encode_set_speed(canwright_frame_t *frame, uint32_t node, const struct speed *message)
{
    const uint32_t speed = (uint32_t)message->speed;
    if (node < 1 || node > 32) {
        return UNKNOWN_NODE;
    }
    frame->id = 0x140 + node;
    frame->dlc = 8;
    frame->reserved[0] = 0;
    frame->reserved[1] = 0;
    frame->reserved[2] = 0;
    frame->data[0] = 0xA2;
    frame->data[1] = 0;
    frame->data[2] = 0;
    frame->data[3] = 0;
    frame->data[4] = (uint8_t)speed;
    frame->data[5] = (uint8_t)(speed >> 8);
    frame->data[6] = (uint8_t)(speed >> 16);
    frame->data[7] = (uint8_t)(speed >> 24);
    return OK;
}
#endif

#if WANTED(3) || WANTED(4) || WANTED(5) || WANTED(7)
static inline int opened(uint32_t *node, const canwright_frame_t *frame, uint8_t code)
{
    *node = frame->id - 0x140;
    if (*node < 1 || *node > 32) {
        return UNKNOWN_ID;
    }
    if (frame->dlc != 8) {
        return WRONG_LENGTH;
    }
    return frame->data[0] == code ? OK : UNKNOWN_CODE;
}
#endif

#if WANTED(3)
int decode_set_torque_reply(
    struct feedback *message, uint32_t *node, const canwright_frame_t *frame, const struct known *known)
{
    const int status = opened(node, frame, 0xA1);
    int16_t second;
    if (status != OK) {
        return status;
    }
    if (known->series == UNKNOWN || known->series > MG) {
        return MISSING_PARAMETER;
    }
    second = (int16_t)(frame->data[2] | frame->data[3] << 8);
    message->temperature = (int8_t)frame->data[1];
    message->power = known->series == MS ? second : 0;
    message->iq = known->series == MS ? 0 : second;
    message->speed = (int16_t)(frame->data[4] | frame->data[5] << 8);
    message->encoder = (uint16_t)(frame->data[6] | frame->data[7] << 8);
    return OK;
}
#endif

#if WANTED(4)
int decode_multi_turn_angle(struct angle *message, uint32_t *node, const canwright_frame_t *frame)
{
    const int status = opened(node, frame, 0x92);
    const uint8_t *data = frame->data;
    uint32_t low, high;
    if (status != OK) {
        return status;
    }
    low = data[1] | (uint32_t)data[2] << 8 | (uint32_t)data[3] << 16 | (uint32_t)data[4] << 24;
    high = data[5] | (uint32_t)data[6] << 8 | (uint32_t)(int8_t)data[7] << 16;
    message->angle = (int64_t)((uint64_t)high << 32 | low);
    return OK;
}
#endif

#if WANTED(5)
int decode_status_1(struct status *message, uint32_t *node, const canwright_frame_t *frame)
{
    const int status = opened(node, frame, 0x9A);
    if (status != OK) {
        return status;
    }
    message->temperature = (int8_t)frame->data[1];
    message->voltage = (uint16_t)(frame->data[3] | frame->data[4] << 8);
    message->errors = frame->data[7];
    return OK;
}
#endif

#if WANTED(7)
int decode_status_3(struct phases *message, uint32_t *node, const canwright_frame_t *frame)
{
    const int status = opened(node, frame, 0x9D);
    if (status != OK) {
        return status;
    }
    message->temperature = (int8_t)frame->data[1];
    message->a = (int16_t)(frame->data[2] | frame->data[3] << 8);
    message->b = (int16_t)(frame->data[4] | frame->data[5] << 8);
    message->c = (int16_t)(frame->data[6] | frame->data[7] << 8);
    return OK;
}
#endif

#if WANTED(6)
/* Not `product / divisor`: a Cortex-M0 calls a function for it, whose flash is not counted. */
static inline int32_t rounded(int32_t product, int shift)
{
    const int32_t half = 1 << (shift - 1);
    return product < 0 ? -((half - product) >> shift) : (product + half) >> shift;
}

int milliamperes(int32_t *milli, int16_t raw, const struct known *known)
{
    switch (known->series) {
    case MF:
        *milli = rounded(raw * 4125, 9);
        return OK;
    case MG:
        *milli = rounded(raw * 4125, 8);
        return OK;
    case MS:
    case MH:
        return NO_SCALE;
    default:
        return MISSING_PARAMETER;
    }
}
#endif

#endif
