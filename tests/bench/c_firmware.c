/*
 * A small firmware: it sends torque setpoints and reads status and position of several motors. It receives replies
 * through the decoder of each message, or, with ANY_REPLY, through the decoder of any reply.
 */
#include <mwd_motor/v2_35.h>

#define P(name) mwd_motor_v2_35_##name

typedef struct {
    int16_t iq;
    int16_t speed;
    uint16_t encoder;
    int8_t temperature;
    uint16_t voltage;
    uint8_t errors;
    int64_t angle;
} state_t;

extern state_t states[33];
extern const P(parameters_t) motor;
extern bool can_send(const canwright_frame_t *frame);

bool control(uint32_t node, int16_t iq);
bool receive(const canwright_frame_t *frame);

bool control(uint32_t node, int16_t iq)
{
    canwright_frame_t frame;
    P(set_torque_request_t) torque;
    torque.iq = iq;
    if (P(set_torque_request_encode)(&frame, node, &torque, &motor) != CANWRIGHT_OK || !can_send(&frame)) {
        return false;
    }
    if (P(read_multi_turn_angle_request_encode)(&frame, node) != CANWRIGHT_OK || !can_send(&frame)) {
        return false;
    }
    return P(read_status_1_request_encode)(&frame, node) == CANWRIGHT_OK && can_send(&frame);
}

static void set_feedback(state_t *state, const P(set_torque_reply_t) * feedback)
{
    state->iq = feedback->iq;
    state->speed = feedback->speed;
    state->encoder = feedback->encoder;
    state->temperature = feedback->temperature;
}

static void set_status(state_t *state, const P(read_status_1_reply_t) * status)
{
    state->voltage = status->voltage;
    state->errors = status->errors;
}

#ifdef ANY_REPLY

bool receive(const canwright_frame_t *frame)
{
    P(any_reply_t) reply;
    if (P(decode_reply)(&reply, frame, &motor) != CANWRIGHT_OK) {
        return false;
    }
    switch (reply.command) {
    case MWD_MOTOR_V2_35_COMMAND_SET_TORQUE:
        set_feedback(&states[reply.node], &reply.as.set_torque);
        return true;
    case MWD_MOTOR_V2_35_COMMAND_READ_STATUS_1:
        set_status(&states[reply.node], &reply.as.read_status_1);
        return true;
    case MWD_MOTOR_V2_35_COMMAND_READ_MULTI_TURN_ANGLE:
        states[reply.node].angle = reply.as.read_multi_turn_angle.angle;
        return true;
    default:
        return false;
    }
}

#else

bool receive(const canwright_frame_t *frame)
{
    P(set_torque_reply_t) feedback;
    P(read_status_1_reply_t) status;
    P(read_multi_turn_angle_reply_t) angle;
    uint32_t node;
    if (P(set_torque_reply_decode)(&feedback, &node, frame, &motor) == CANWRIGHT_OK) {
        set_feedback(&states[node], &feedback);
        return true;
    }
    if (P(read_status_1_reply_decode)(&status, &node, frame) == CANWRIGHT_OK) {
        set_status(&states[node], &status);
        return true;
    }
    if (P(read_multi_turn_angle_reply_decode)(&angle, &node, frame) == CANWRIGHT_OK) {
        states[node].angle = angle.angle;
        return true;
    }
    return false;
}

#endif
