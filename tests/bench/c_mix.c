/*
 * A host that receives the replies of one control cycle as raw integers. The decoder is generated, or, with BY_HAND,
 * written for this motor: it checks id, length, code and that the series of a torque reply is known, as the generated one.
 */
#include <mwd_motor/v2_35.h>

#define VALUE int64_t

#ifndef BY_HAND

typedef mwd_motor_v2_35_parameters_t motor_t;

static motor_t motor_of(int count)
{
    motor_t motor = CANWRIGHT_ZERO;
    motor.series = count > 1 ? MWD_MOTOR_V2_35_SERIES_MF : MWD_MOTOR_V2_35_SERIES_MG;
    return motor;
}

#define COMMAND(name) MWD_MOTOR_V2_35_COMMAND_##name

static inline int receive(VALUE *sum, const canwright_frame_t *frame, const motor_t *motor)
{
    mwd_motor_v2_35_any_reply_t reply;
    const canwright_status_t status = mwd_motor_v2_35_decode_reply(&reply, frame, motor);
    if (status != CANWRIGHT_OK) {
        return (int)status;
    }
    switch (reply.command) {
    case COMMAND(SET_TORQUE):
    case COMMAND(SET_SPEED):
    case COMMAND(MOVE_TO_ANGLE_AT_SPEED):
    case COMMAND(READ_STATUS_2):
        *sum += reply.as.read_status_2.temperature + reply.as.read_status_2.iq + reply.as.read_status_2.speed +
            reply.as.read_status_2.encoder;
        break;
    case COMMAND(READ_MULTI_TURN_ANGLE):
        *sum += reply.as.read_multi_turn_angle.angle;
        break;
    case COMMAND(READ_SINGLE_TURN_ANGLE):
        *sum += reply.as.read_single_turn_angle.angle;
        break;
    case COMMAND(READ_STATUS_1):
        *sum += reply.as.read_status_1.temperature + reply.as.read_status_1.voltage + reply.as.read_status_1.errors;
        break;
    case COMMAND(READ_STATUS_3):
        *sum += reply.as.read_status_3.temperature + reply.as.read_status_3.phase_a + reply.as.read_status_3.phase_b +
            reply.as.read_status_3.phase_c;
        break;
    case COMMAND(READ_ENCODER):
        *sum += reply.as.read_encoder.encoder;
        break;
    case COMMAND(READ_ACCELERATION):
        *sum += reply.as.read_acceleration.acceleration;
        break;
    case COMMAND(READ_PID):
        *sum += reply.as.read_pid.angle_kp + reply.as.read_pid.angle_ki;
        break;
    default:
        break;
    }
    *sum += reply.node;
    return (int)status;
}

#else

enum { OK, UNKNOWN_ID, UNKNOWN_CODE, WRONG_LENGTH, MISSING_PARAMETER };

typedef struct {
    enum { SERIES_UNKNOWN, MS, MF, MH, MG } series;
} motor_t;

static motor_t motor_of(int count)
{
    motor_t motor;
    motor.series = count > 1 ? MF : MG;
    return motor;
}

typedef struct {
    uint8_t code;
    uint32_t node;
    union {
        struct {
            int8_t temperature;
            int16_t power, iq, speed;
            uint16_t encoder;
        } feedback;
        struct {
            int8_t temperature;
            uint16_t voltage;
            uint8_t errors;
        } status_1;
        struct {
            int8_t temperature;
            int16_t phase[3];
        } status_3;
        struct {
            uint8_t angle_kp, angle_ki, speed_kp, speed_ki, iq_kp, iq_ki;
        } pid;
        struct {
            uint16_t encoder, measured, offset;
        } encoder;
        int64_t multi_turn;
        uint32_t single_turn;
        int32_t acceleration;
        uint16_t encoder_offset;
    } as;
} reply_t;

static inline uint16_t u16(const uint8_t *data)
{
    return (uint16_t)(data[0] | data[1] << 8);
}

static inline uint32_t u32(const uint8_t *data)
{
    return (uint32_t)data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16 | (uint32_t)data[3] << 24;
}

static inline int decode(reply_t *reply, const canwright_frame_t *frame, const motor_t *motor)
{
    const uint8_t *data = frame->data;
    const uint32_t node = frame->id - 0x140u;
    uint32_t high;
    if (node < 1u || node > 32u) {
        return UNKNOWN_ID;
    }
    if (frame->dlc != 8u) {
        return WRONG_LENGTH;
    }
    reply->node = node;
    reply->code = data[0];
    switch (data[0]) {
    case 0x80:
    case 0x81:
    case 0x88:
    case 0x95:
        return OK;
    case 0xA0:
    case 0xA1:
    case 0xA2:
    case 0xA3:
    case 0xA4:
    case 0xA5:
    case 0xA6:
    case 0xA7:
    case 0xA8:
    case 0x9C:
        if (motor->series == SERIES_UNKNOWN || motor->series > MG) {
            return MISSING_PARAMETER;
        }
        reply->as.feedback.temperature = (int8_t)data[1];
        reply->as.feedback.power = motor->series == MS ? (int16_t)u16(data + 2) : 0;
        reply->as.feedback.iq = motor->series == MS ? 0 : (int16_t)u16(data + 2);
        reply->as.feedback.speed = (int16_t)u16(data + 4);
        reply->as.feedback.encoder = u16(data + 6);
        return OK;
    case 0x30:
    case 0x31:
    case 0x32:
        reply->as.pid.angle_kp = data[2];
        reply->as.pid.angle_ki = data[3];
        reply->as.pid.speed_kp = data[4];
        reply->as.pid.speed_ki = data[5];
        reply->as.pid.iq_kp = data[6];
        reply->as.pid.iq_ki = data[7];
        return OK;
    case 0x33:
    case 0x34:
        reply->as.acceleration = (int32_t)u32(data + 4);
        return OK;
    case 0x90:
        reply->as.encoder.encoder = u16(data + 2);
        reply->as.encoder.measured = u16(data + 4);
        reply->as.encoder.offset = u16(data + 6);
        return OK;
    case 0x91:
    case 0x19:
        reply->as.encoder_offset = u16(data + 6);
        return OK;
    case 0x92:
        high = u16(data + 5) | (uint32_t)(int8_t)data[7] << 16;
        reply->as.multi_turn = (int64_t)((uint64_t)high << 32 | u32(data + 1));
        return OK;
    case 0x94:
        reply->as.single_turn = u32(data + 4);
        return OK;
    case 0x9A:
    case 0x9B:
        reply->as.status_1.temperature = (int8_t)data[1];
        reply->as.status_1.voltage = u16(data + 3);
        reply->as.status_1.errors = data[7];
        return OK;
    case 0x9D:
        reply->as.status_3.temperature = (int8_t)data[1];
        reply->as.status_3.phase[0] = (int16_t)u16(data + 2);
        reply->as.status_3.phase[1] = (int16_t)u16(data + 4);
        reply->as.status_3.phase[2] = (int16_t)u16(data + 6);
        return OK;
    default:
        return UNKNOWN_CODE;
    }
}

static inline int receive(VALUE *sum, const canwright_frame_t *frame, const motor_t *motor)
{
    reply_t reply;
    const int status = decode(&reply, frame, motor);
    if (status != OK) {
        return status;
    }
    switch (reply.code) {
    case 0xA1:
    case 0xA2:
    case 0xA4:
    case 0x9C:
        *sum += reply.as.feedback.temperature + reply.as.feedback.iq + reply.as.feedback.speed +
            reply.as.feedback.encoder;
        break;
    case 0x92:
        *sum += reply.as.multi_turn;
        break;
    case 0x94:
        *sum += reply.as.single_turn;
        break;
    case 0x9A:
        *sum += reply.as.status_1.temperature + reply.as.status_1.voltage + reply.as.status_1.errors;
        break;
    case 0x9D:
        *sum += reply.as.status_3.temperature + reply.as.status_3.phase[0] + reply.as.status_3.phase[1] +
            reply.as.status_3.phase[2];
        break;
    case 0x90:
        *sum += reply.as.encoder.encoder;
        break;
    case 0x33:
        *sum += reply.as.acceleration;
        break;
    case 0x30:
        *sum += reply.as.pid.angle_kp + reply.as.pid.angle_ki;
        break;
    default:
        break;
    }
    *sum += reply.node;
    return status;
}

#endif

#include "c_cycle.h"
