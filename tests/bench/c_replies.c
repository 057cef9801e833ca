/*
 * A host that receives the replies of one control cycle and uses their values in units. The decoder is generated, or,
 * with BY_HAND, written for this motor, with the same checks and the same values.
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <mwd_motor/v2_35.h>
#include <mwd_motor/v2_35_float.h>

#define FRAMES 12u
#define CYCLES 1000u

/* The frames of one control cycle of an MG motor. */
static const struct {
    uint32_t id;
    uint8_t data[8];
} CYCLE[FRAMES] = {
    {0x141u, {0xA1, 0x32, 0x9B, 0x00, 0xF4, 0x01, 0x00, 0x80}},
    {0x142u, {0x92, 0xB0, 0x3C, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}},
    {0x143u, {0x9A, 0x32, 0x00, 0xE7, 0x01, 0x00, 0x00, 0x08}},
    {0x141u, {0x9C, 0x1E, 0x65, 0xFF, 0x0C, 0xFE, 0x34, 0x12}},
    {0x144u, {0xA4, 0x21, 0x10, 0x02, 0xC8, 0x00, 0xFF, 0xFF}},
    {0x141u, {0x94, 0x00, 0x00, 0x00, 0x50, 0x46, 0x00, 0x00}},
    {0x142u, {0x90, 0x00, 0x10, 0x20, 0x00, 0x30, 0x00, 0x10}},
    {0x143u, {0x9D, 0x28, 0x40, 0x00, 0xC0, 0xFF, 0x80, 0x01}},
    {0x145u, {0x88, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00}},
    {0x141u, {0x30, 0x00, 0x64, 0x32, 0x28, 0x0E, 0x1E, 0x1E}},
    {0x142u, {0xA2, 0x2C, 0xCE, 0xFF, 0x18, 0xFC, 0x00, 0x40}},
    {0x141u, {0x33, 0x00, 0x00, 0x00, 0x10, 0x27, 0x00, 0x00}},
};

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
#define COMMAND(name) MWD_MOTOR_V2_35_COMMAND_##name

static int receive(double *sum, const canwright_frame_t *frame, const motor_t *motor)
{
    CALL(any_reply_t) reply;
    double iq = 0.0;
    double encoder = 0.0;
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
        status = CALL(torque_current_to_double)(&iq, reply.as.read_status_2.iq, motor);
        if (status == CANWRIGHT_OK) {
            status = CALL(encoder_position_to_double)(&encoder, reply.as.read_status_2.encoder, motor);
        }
        *sum += CALL(temperature_to_double)(reply.as.read_status_2.temperature) + iq +
            CALL(speed_i16_to_double)(reply.as.read_status_2.speed) + encoder;
        break;
    case COMMAND(READ_MULTI_TURN_ANGLE):
        *sum += CALL(multi_turn_angle_to_double)(reply.as.read_multi_turn_angle.angle);
        break;
    case COMMAND(READ_SINGLE_TURN_ANGLE):
        *sum += CALL(single_turn_angle_to_double)(reply.as.read_single_turn_angle.angle);
        break;
    case COMMAND(READ_STATUS_1):
    case COMMAND(CLEAR_ERRORS):
        *sum += CALL(temperature_to_double)(reply.as.read_status_1.temperature) +
            CALL(voltage_to_double)(reply.as.read_status_1.voltage) + (double)reply.as.read_status_1.errors;
        break;
    case COMMAND(READ_STATUS_3):
        *sum += CALL(temperature_to_double)(reply.as.read_status_3.temperature) +
            CALL(phase_current_to_double)(reply.as.read_status_3.phase_a) +
            CALL(phase_current_to_double)(reply.as.read_status_3.phase_b) +
            CALL(phase_current_to_double)(reply.as.read_status_3.phase_c);
        break;
    case COMMAND(READ_ENCODER):
        status = CALL(encoder_position_to_double)(&encoder, reply.as.read_encoder.encoder, motor);
        *sum += encoder;
        break;
    case COMMAND(READ_ACCELERATION):
        *sum += CALL(acceleration_to_double)(reply.as.read_acceleration.acceleration);
        break;
    case COMMAND(READ_PID):
        *sum += (double)reply.as.read_pid.angle_kp + (double)reply.as.read_pid.angle_ki;
        break;
    default:
        break;
    }
    *sum += (double)reply.node;
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
            double temperature, power, iq, speed, encoder;
        } feedback;
        struct {
            double temperature, voltage;
            uint8_t errors;
        } status_1;
        struct {
            double temperature, phase[3];
        } status_3;
        struct {
            uint8_t angle_kp, angle_ki, speed_kp, speed_ki, iq_kp, iq_ki;
        } pid;
        struct {
            double encoder, measured, offset;
        } encoder;
        double angle;
        double acceleration;
        double encoder_offset;
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
static inline int amperes(double *value, int16_t raw, const motor_t *motor)
{
    switch (motor->series) {
    case MF:
        *value = raw * 33 / 4096.0;
        return OK;
    case MG:
        *value = raw * 33 / 2048.0;
        return OK;
    case MS:
    case MH:
        return NO_SCALE;
    default:
        return MISSING_PARAMETER;
    }
}

static inline int degrees(double *value, uint16_t raw, const motor_t *motor)
{
    switch (motor->encoder_bits) {
    case 14:
        *value = raw * (45.0 / 2048.0);
        return OK;
    case 15:
        *value = raw * (45.0 / 4096.0);
        return OK;
    case 18:
        *value = raw * (45.0 / 8192.0);
        return OK;
    default:
        return MISSING_PARAMETER;
    }
}

/* The hundredth part of up to 56 bits, rounded once. */
static inline double hundredth(int64_t raw)
{
    const int64_t exact = INT64_C(1) << 53;
    if (raw >= -exact && raw <= exact) {
        return (double)raw / 100.0;
    }
    return (double)(raw / 100) + (double)(raw % 100) / 100.0;
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
        reply->as.angle = hundredth(
            (int64_t)((uint64_t)u32(data + 1) << 8 | (uint64_t)u16(data + 5) << 40 | (uint64_t)data[7] << 56) >> 8);
        return OK;
    case 0x94:
        reply->as.angle = u32(data + 4) / 100.0;
        return OK;
    case 0x9A:
    case 0x9B:
        reply->as.status_1.temperature = (int8_t)data[1];
        reply->as.status_1.voltage = u16(data + 3) / 10.0;
        reply->as.status_1.errors = data[7];
        return OK;
    case 0x9D:
        reply->as.status_3.temperature = (int8_t)data[1];
        reply->as.status_3.phase[0] = (int16_t)u16(data + 2) / 64.0;
        reply->as.status_3.phase[1] = (int16_t)u16(data + 4) / 64.0;
        reply->as.status_3.phase[2] = (int16_t)u16(data + 6) / 64.0;
        return OK;
    default:
        return UNKNOWN_CODE;
    }
}

static int receive(double *sum, const canwright_frame_t *frame, const motor_t *motor)
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

__attribute__((noinline)) int receive_cycle(double *sum, const canwright_frame_t *frames, const motor_t *motor)
{
    int failures = 0;
    unsigned i;
    for (i = 0u; i < FRAMES; i++) {
        failures += receive(sum, &frames[i], motor) != 0;
    }
    return failures;
}

/* Prints the number of cycles. The motor depends on the arguments, so that a compiler does not know it. */
int main(int count, char **arguments)
{
    const motor_t motor = motor_of(count);
    canwright_frame_t frames[FRAMES];
    double sum = 0.0;
    int failures = 0;
    unsigned i;
    (void)arguments;
    for (i = 0u; i < FRAMES; i++) {
        frames[i].id = CYCLE[i].id;
        frames[i].dlc = 8u;
        memcpy(frames[i].data, CYCLE[i].data, 8u);
    }
    for (i = 0u; i < CYCLES; i++) {
        failures += receive_cycle(&sum, frames, &motor);
    }
    printf("%u\n", CYCLES);
    fprintf(stderr, "%.17g\n", sum);
    return failures;
}
