/*
 * A small firmware: it sends torque setpoints and reads status and position of several motors. It receives replies
 * through the decoder of each message; with ANY_REPLY, through the decoder of any reply; with IDENTIFY, through the
 * function that identifies any reply and those that read fields.
 *
 * Two programs are written for this motor. Both check what the generated code checks: the series that have torque
 * control, the node of each frame, the range of the current; id, length and code of a reply, and that the series of a
 * torque reply is known. Both set every byte of a frame that they send. With BY_HAND, there is a function for each message,
 * which returns why a frame is rejected, as a driver does. With BY_HAND_SWITCH, all is in two functions: the node is
 * checked once for three requests, and no reason is returned.
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

#ifdef BY_HAND

enum { OK, UNKNOWN_ID, UNKNOWN_CODE, WRONG_LENGTH, MISSING_PARAMETER, OUT_OF_RANGE, UNKNOWN_NODE, NOT_AVAILABLE };

static int request(canwright_frame_t *frame, uint32_t node, uint8_t code)
{
    uint8_t i;
    if (node < 1u || node > 32u) {
        return UNKNOWN_NODE;
    }
    frame->id = 0x140u + node;
    frame->dlc = 8u;
    frame->reserved[0] = 0u;
    frame->reserved[1] = 0u;
    frame->reserved[2] = 0u;
    frame->data[0] = code;
    for (i = 1u; i < 8u; i++) {
        frame->data[i] = 0u;
    }
    return OK;
}

static int set_torque(canwright_frame_t *frame, uint32_t node, int16_t iq)
{
    int status;
    if (motor.series == MWD_MOTOR_V2_35_SERIES_MS) {
        return NOT_AVAILABLE;
    }
    status = request(frame, node, 0xA1u);
    if (status != OK) {
        return status;
    }
    if (iq < -2048 || iq > 2048) {
        return OUT_OF_RANGE;
    }
    frame->data[4] = (uint8_t)iq;
    frame->data[5] = (uint8_t)((uint16_t)iq >> 8);
    return OK;
}

bool control(uint32_t node, int16_t iq)
{
    canwright_frame_t frame;
    if (set_torque(&frame, node, iq) != OK || !can_send(&frame)) {
        return false;
    }
    if (request(&frame, node, 0x92u) != OK || !can_send(&frame)) {
        return false;
    }
    return request(&frame, node, 0x9Au) == OK && can_send(&frame);
}

static int reply(uint32_t *node, const canwright_frame_t *frame, uint8_t code)
{
    *node = frame->id - 0x140u;
    if (*node < 1u || *node > 32u) {
        return UNKNOWN_ID;
    }
    if (frame->dlc != 8u) {
        return WRONG_LENGTH;
    }
    return frame->data[0] == code ? OK : UNKNOWN_CODE;
}

static int torque_reply(state_t *state, uint32_t *node, const canwright_frame_t *frame)
{
    const uint8_t *data = frame->data;
    const int status = reply(node, frame, 0xA1u);
    int16_t iq;
    if (status != OK) {
        return status;
    }
    if (motor.series == MWD_MOTOR_V2_35_SERIES_UNKNOWN || (int)motor.series > (int)MWD_MOTOR_V2_35_SERIES_MG) {
        return MISSING_PARAMETER;
    }
    iq = (int16_t)(data[2] | data[3] << 8);
    state->iq = motor.series == MWD_MOTOR_V2_35_SERIES_MS ? (int16_t)0 : iq;
    state->speed = (int16_t)(data[4] | data[5] << 8);
    state->encoder = (uint16_t)(data[6] | data[7] << 8);
    state->temperature = (int8_t)data[1];
    return OK;
}

static int status_reply(state_t *state, uint32_t *node, const canwright_frame_t *frame)
{
    const uint8_t *data = frame->data;
    const int status = reply(node, frame, 0x9Au);
    if (status != OK) {
        return status;
    }
    state->voltage = (uint16_t)(data[3] | data[4] << 8);
    state->errors = data[7];
    return OK;
}

static int angle_reply(state_t *state, uint32_t *node, const canwright_frame_t *frame)
{
    const uint8_t *data = frame->data;
    const int status = reply(node, frame, 0x92u);
    uint32_t low;
    uint32_t high;
    if (status != OK) {
        return status;
    }
    low = data[1] | (uint32_t)data[2] << 8 | (uint32_t)data[3] << 16 | (uint32_t)data[4] << 24;
    high = data[5] | (uint32_t)data[6] << 8 | (uint32_t)(int8_t)data[7] << 16;
    state->angle = (int64_t)((uint64_t)high << 32 | low);
    return OK;
}

bool receive(const canwright_frame_t *frame)
{
    state_t state;
    uint32_t node;
    if (torque_reply(&state, &node, frame) == OK) {
        states[node].iq = state.iq;
        states[node].speed = state.speed;
        states[node].encoder = state.encoder;
        states[node].temperature = state.temperature;
        return true;
    }
    if (status_reply(&state, &node, frame) == OK) {
        states[node].voltage = state.voltage;
        states[node].errors = state.errors;
        return true;
    }
    if (angle_reply(&state, &node, frame) == OK) {
        states[node].angle = state.angle;
        return true;
    }
    return false;
}

#elif defined(BY_HAND_SWITCH)

static void start(canwright_frame_t *frame, uint32_t node, uint8_t code)
{
    uint8_t i;
    frame->id = 0x140u + node;
    frame->dlc = 8u;
    frame->reserved[0] = 0u;
    frame->reserved[1] = 0u;
    frame->reserved[2] = 0u;
    frame->data[0] = code;
    for (i = 1u; i < 8u; i++) {
        frame->data[i] = 0u;
    }
}

bool control(uint32_t node, int16_t iq)
{
    canwright_frame_t frame;
    if (node < 1u || node > 32u || motor.series == MWD_MOTOR_V2_35_SERIES_MS || iq < -2048 || iq > 2048) {
        return false;
    }
    start(&frame, node, 0xA1u);
    frame.data[4] = (uint8_t)iq;
    frame.data[5] = (uint8_t)((uint16_t)iq >> 8);
    if (!can_send(&frame)) {
        return false;
    }
    start(&frame, node, 0x92u);
    if (!can_send(&frame)) {
        return false;
    }
    start(&frame, node, 0x9Au);
    return can_send(&frame);
}

bool receive(const canwright_frame_t *frame)
{
    const uint8_t *data = frame->data;
    const uint32_t node = frame->id - 0x140u;
    state_t *state;
    int16_t iq;
    uint32_t low;
    uint32_t high;
    if (node < 1u || node > 32u || frame->dlc != 8u) {
        return false;
    }
    state = &states[node];
    switch (data[0]) {
    case 0xA1:
        if (motor.series == MWD_MOTOR_V2_35_SERIES_UNKNOWN || (int)motor.series > (int)MWD_MOTOR_V2_35_SERIES_MG) {
            return false;
        }
        iq = (int16_t)(data[2] | data[3] << 8);
        state->iq = motor.series == MWD_MOTOR_V2_35_SERIES_MS ? (int16_t)0 : iq;
        state->speed = (int16_t)(data[4] | data[5] << 8);
        state->encoder = (uint16_t)(data[6] | data[7] << 8);
        state->temperature = (int8_t)data[1];
        return true;
    case 0x9A:
        state->voltage = (uint16_t)(data[3] | data[4] << 8);
        state->errors = data[7];
        return true;
    case 0x92:
        low = data[1] | (uint32_t)data[2] << 8 | (uint32_t)data[3] << 16 | (uint32_t)data[4] << 24;
        high = data[5] | (uint32_t)data[6] << 8 | (uint32_t)(int8_t)data[7] << 16;
        state->angle = (int64_t)((uint64_t)high << 32 | low);
        return true;
    default:
        return false;
    }
}

#else

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

#ifdef IDENTIFY

bool receive(const canwright_frame_t *frame)
{
    P(command_t) command;
    P(set_torque_reply_t) feedback;
    P(read_status_1_reply_t) status;
    P(read_multi_turn_angle_reply_t) angle;
    uint32_t node;
    if (P(identify_reply)(&command, &node, frame) != CANWRIGHT_OK) {
        return false;
    }
    switch (command) {
    case MWD_MOTOR_V2_35_COMMAND_SET_TORQUE:
        if (P(motion_feedback_unpack)(&feedback, frame, &motor) != CANWRIGHT_OK) {
            return false;
        }
        set_feedback(&states[node], &feedback);
        return true;
    case MWD_MOTOR_V2_35_COMMAND_READ_STATUS_1:
        P(status_1_unpack)(&status, frame);
        set_status(&states[node], &status);
        return true;
    case MWD_MOTOR_V2_35_COMMAND_READ_MULTI_TURN_ANGLE:
        P(read_multi_turn_angle_reply_unpack)(&angle, frame);
        states[node].angle = angle.angle;
        return true;
    default:
        return false;
    }
}

#elif defined(ANY_REPLY)

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

#endif
