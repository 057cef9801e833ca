/* What the generated sketches use of the TWAI driver of ESP-IDF. The bus has a frame of another node, and then, if REPLY_ID and
   REPLY_DATA are defined, the reply. */
#ifndef TWAI_H
#define TWAI_H

#include <stdint.h>

enum gpio_num_t { GPIO_NUM_4 = 4, GPIO_NUM_5 = 5 };
enum twai_mode_t { TWAI_MODE_NORMAL };
typedef int esp_err_t;
typedef uint32_t TickType_t;

#define ESP_OK 0
#define ESP_FAIL -1
#define pdMS_TO_TICKS(milliseconds) (static_cast<TickType_t>(milliseconds))

struct twai_general_config_t {
    twai_mode_t mode;
    gpio_num_t tx_io;
    gpio_num_t rx_io;
};
struct twai_timing_config_t {
    uint32_t bit_rate;
};
struct twai_filter_config_t {
    uint32_t acceptance_code;
    uint32_t acceptance_mask;
    bool single_filter;
};
struct twai_message_t {
    uint32_t extd : 1;
    uint32_t rtr : 1;
    uint32_t identifier;
    uint8_t data_length_code;
    uint8_t data[8];
};

#define TWAI_GENERAL_CONFIG_DEFAULT(tx_io_num, rx_io_num, op_mode) {op_mode, tx_io_num, rx_io_num}
#define TWAI_TIMING_CONFIG_125KBITS() {125000u}
#define TWAI_TIMING_CONFIG_250KBITS() {250000u}
#define TWAI_TIMING_CONFIG_500KBITS() {500000u}
#define TWAI_TIMING_CONFIG_1MBITS() {1000000u}
#define TWAI_FILTER_CONFIG_ACCEPT_ALL() {0u, 0xFFFFFFFFu, true}

static int frames_on_the_bus = 0;

static inline esp_err_t twai_driver_install(
    const twai_general_config_t *general, const twai_timing_config_t *timing, const twai_filter_config_t *filter)
{
    return general->tx_io != general->rx_io && timing->bit_rate != 0u && filter->single_filter ? ESP_OK : ESP_FAIL;
}

static inline esp_err_t twai_start()
{
    return ESP_OK;
}

static inline esp_err_t twai_transmit(const twai_message_t *message, TickType_t)
{
    frames_on_the_bus = message->data_length_code <= 8u ? 2 : 0;
    return ESP_OK;
}

static inline esp_err_t twai_receive(twai_message_t *message, TickType_t)
{
    if (frames_on_the_bus == 2) {
        frames_on_the_bus = 1;
        *message = {0u, 0u, 0x7FEu, 1u, {1u}};
        return ESP_OK;
    }
#if defined(REPLY_ID)
    if (frames_on_the_bus == 1) {
        frames_on_the_bus = 0;
        *message = {0u, 0u, REPLY_ID, 8u, {REPLY_DATA}};
        return ESP_OK;
    }
#endif
    return ESP_FAIL;
}

#endif
