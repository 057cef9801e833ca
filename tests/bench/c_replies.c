/*
 * A host that receives the replies of one control cycle and uses their values in units, of type VALUE. The decoder is
 * generated, or, with BY_HAND, written for this motor, with the same checks and the same values. Freestanding, there is
 * no program around it.
 */
#include <mwd_motor/v2_35.h>
#include <mwd_motor/v2_35_float.h>

#ifndef VALUE
#define VALUE double
#endif
#define JOINED(a, b) a##b
#define TO(type, value) JOINED(type##_to_, value)

#ifndef BY_HAND

typedef mwd_motor_v2_35_parameters_t motor_t;

static motor_t motor_of(int count)
{
    motor_t motor;
    motor.series = count > 1 ? MWD_MOTOR_V2_35_SERIES_MF : MWD_MOTOR_V2_35_SERIES_MG;
    motor.encoder_bits = count > 1 ? MWD_MOTOR_V2_35_ENCODER_BITS_15 : MWD_MOTOR_V2_35_ENCODER_BITS_18;
    motor.gear_ratio.numerator = 1;
    motor.gear_ratio.denominator = 1u;
    return motor;
}

#define CALL(name) mwd_motor_v2_35_##name
#define TO_VALUE(name) TO(mwd_motor_v2_35_##name, VALUE)
#define COMMAND(name) MWD_MOTOR_V2_35_COMMAND_##name

static inline int receive(VALUE *sum, const canwright_frame_t *frame, const motor_t *motor)
{
    CALL(any_reply_t) reply;
    VALUE iq = 0.0;
    VALUE encoder = 0.0;
    canwright_status_t status = CALL(decode_reply)(&reply, frame, motor);
    if (status != CANWRIGHT_OK) {
        return (int)status;
    }
    switch (reply.command) {
    case COMMAND(SET_TORQUE):
    case COMMAND(SET_SPEED):
    case COMMAND(MOVE_TO_ANGLE):
    case COMMAND(MOVE_TO_ANGLE_AT_SPEED):
    case COMMAND(TURN_TO_ANGLE):
    case COMMAND(TURN_TO_ANGLE_AT_SPEED):
    case COMMAND(MOVE_BY_ANGLE):
    case COMMAND(MOVE_BY_ANGLE_AT_SPEED):
    case COMMAND(READ_STATUS_2):
        status = TO_VALUE(torque_current)(&iq, reply.as.read_status_2.iq, motor);
        if (status == CANWRIGHT_OK) {
            status = TO_VALUE(encoder_position)(&encoder, reply.as.read_status_2.encoder, motor);
        }
        *sum += TO_VALUE(temperature)(reply.as.read_status_2.temperature) + iq +
            TO_VALUE(speed_i16)(reply.as.read_status_2.speed) + encoder;
        break;
    case COMMAND(READ_MULTI_TURN_ANGLE):
        *sum += TO_VALUE(multi_turn_angle)(reply.as.read_multi_turn_angle.angle);
        break;
    case COMMAND(READ_SINGLE_TURN_ANGLE):
        *sum += TO_VALUE(single_turn_angle)(reply.as.read_single_turn_angle.angle);
        break;
    case COMMAND(READ_STATUS_1):
    case COMMAND(CLEAR_ERRORS):
        *sum += TO_VALUE(temperature)(reply.as.read_status_1.temperature) +
            TO_VALUE(voltage)(reply.as.read_status_1.voltage) + (VALUE)reply.as.read_status_1.errors;
        break;
    case COMMAND(READ_STATUS_3):
        *sum += TO_VALUE(temperature)(reply.as.read_status_3.temperature) +
            TO_VALUE(phase_current)(reply.as.read_status_3.phase_a) +
            TO_VALUE(phase_current)(reply.as.read_status_3.phase_b) +
            TO_VALUE(phase_current)(reply.as.read_status_3.phase_c);
        break;
    case COMMAND(READ_ENCODER):
        status = TO_VALUE(encoder_position)(&encoder, reply.as.read_encoder.encoder, motor);
        *sum += encoder;
        break;
    case COMMAND(READ_ACCELERATION):
        *sum += TO_VALUE(acceleration)(reply.as.read_acceleration.acceleration);
        break;
    case COMMAND(READ_PID):
        *sum += (VALUE)reply.as.read_pid.angle_kp + (VALUE)reply.as.read_pid.angle_ki;
        break;
    default:
        break;
    }
    *sum += (VALUE)reply.node;
    return (int)status;
}

#else

enum { OK, UNKNOWN_ID, UNKNOWN_CODE, WRONG_LENGTH, NO_SCALE, MISSING_PARAMETER };

typedef struct {
    enum { SERIES_UNKNOWN, MS, MF, MH, MG } series;
    int encoder_bits;
} motor_t;

static motor_t motor_of(int count)
{
    motor_t motor;
    motor.series = count > 1 ? MF : MG;
    motor.encoder_bits = count > 1 ? 15 : 18;
    return motor;
}

typedef struct {
    uint8_t code;
    uint32_t node;
    union {
        struct {
            VALUE temperature, power, iq, speed, encoder;
        } feedback;
        struct {
            VALUE temperature, voltage;
            uint8_t errors;
        } status_1;
        struct {
            VALUE temperature, phase[3];
        } status_3;
        struct {
            uint8_t angle_kp, angle_ki, speed_kp, speed_ki, iq_kp, iq_ki;
        } pid;
        struct {
            VALUE encoder, measured, offset;
        } encoder;
        VALUE angle;
        VALUE acceleration;
        VALUE encoder_offset;
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

static inline int64_t i56(const uint8_t *data)
{
    const uint32_t high = u16(data + 4) | (uint32_t)(int8_t)data[6] << 16;
    return (int64_t)((uint64_t)high << 32 | u32(data));
}

static inline int amperes(VALUE *value, int16_t raw, const motor_t *motor)
{
    switch (motor->series) {
    case MF:
        *value = raw * 33 / (VALUE)4096.0;
        return OK;
    case MG:
        *value = raw * 33 / (VALUE)2048.0;
        return OK;
    case MS:
    case MH:
        return NO_SCALE;
    default:
        return MISSING_PARAMETER;
    }
}

static inline int degrees(VALUE *value, uint16_t raw, const motor_t *motor)
{
    switch (motor->encoder_bits) {
    case 14:
        *value = raw * ((VALUE)45.0 / (VALUE)2048.0);
        return OK;
    case 15:
        *value = raw * ((VALUE)45.0 / (VALUE)4096.0);
        return OK;
    case 18:
        *value = raw * ((VALUE)45.0 / (VALUE)8192.0);
        return OK;
    default:
        return MISSING_PARAMETER;
    }
}

static inline int decode(reply_t *reply, const canwright_frame_t *frame, const motor_t *motor)
{
    const uint8_t *data = frame->data;
    const uint32_t node = frame->id - 0x140u;
    int status;
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
        reply->as.feedback.temperature = (int8_t)data[1];
        reply->as.feedback.speed = (int16_t)u16(data + 4);
        if (motor->series == MS) {
            reply->as.feedback.power = (int16_t)u16(data + 2);
            reply->as.feedback.iq = 0;
        } else {
            reply->as.feedback.power = 0;
            status = amperes(&reply->as.feedback.iq, (int16_t)u16(data + 2), motor);
            if (status != OK) {
                return status;
            }
        }
        return degrees(&reply->as.feedback.encoder, u16(data + 6), motor);
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
        status = degrees(&reply->as.encoder.encoder, u16(data + 2), motor);
        if (status == OK) {
            (void)degrees(&reply->as.encoder.measured, u16(data + 4), motor);
            (void)degrees(&reply->as.encoder.offset, u16(data + 6), motor);
        }
        return status;
    case 0x91:
    case 0x19:
        return degrees(&reply->as.encoder_offset, u16(data + 6), motor);
    case 0x92:
        reply->as.angle = (VALUE)i56(data + 1) / (VALUE)100.0;
        return OK;
    case 0x94:
        reply->as.angle = u32(data + 4) / (VALUE)100.0;
        return OK;
    case 0x9A:
    case 0x9B:
        reply->as.status_1.temperature = (int8_t)data[1];
        reply->as.status_1.voltage = u16(data + 3) / (VALUE)10.0;
        reply->as.status_1.errors = data[7];
        return OK;
    case 0x9D:
        reply->as.status_3.temperature = (int8_t)data[1];
        reply->as.status_3.phase[0] = (int16_t)u16(data + 2) / (VALUE)64.0;
        reply->as.status_3.phase[1] = (int16_t)u16(data + 4) / (VALUE)64.0;
        reply->as.status_3.phase[2] = (int16_t)u16(data + 6) / (VALUE)64.0;
        return OK;
    default:
        return UNKNOWN_CODE;
    }
}

static inline int receive(VALUE *sum, const canwright_frame_t *frame, const motor_t *motor)
{
    reply_t reply;
    int status = decode(&reply, frame, motor);
    if (status != OK) {
        return status;
    }
    switch (reply.code) {
    case 0xA1:
    case 0xA2:
    case 0xA3:
    case 0xA4:
    case 0xA5:
    case 0xA6:
    case 0xA7:
    case 0xA8:
    case 0x9C:
        *sum += reply.as.feedback.temperature + reply.as.feedback.iq + reply.as.feedback.speed +
            reply.as.feedback.encoder;
        break;
    case 0x92:
    case 0x94:
        *sum += reply.as.angle;
        break;
    case 0x9A:
    case 0x9B:
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
