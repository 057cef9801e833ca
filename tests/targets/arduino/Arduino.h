/* What the generated sketches use of Arduino's core: a serial port, and a main function that runs `loop` once. */
#ifndef ARDUINO_H
#define ARDUINO_H

#include <stdint.h>

#if defined(__AVR__)
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

static inline void put(char character)
{
    while ((UCSR0A & (1u << UDRE0)) == 0u) {
    }
    UDR0 = static_cast<uint8_t>(character);
}
static inline void start()
{
    UCSR0B = 1u << TXEN0;
}
static inline void stop()
{
    cli();
    sleep_mode(); /* Ends the simulation, as no interrupt can occur. */
}
#else
#include <stdio.h>

static inline void put(char character)
{
    putchar(character);
}
static inline void start()
{
}
static inline void stop()
{
}
#endif

enum Base { DEC = 10, HEX = 16 };

struct SerialPort {
    void begin(unsigned long)
    {
        start();
    }
    void print(char character)
    {
        put(character);
    }
    void print(const char *text)
    {
        while (*text != '\0') {
            put(*text++);
        }
    }
    void print(unsigned long number, Base base)
    {
        if (number >= static_cast<unsigned long>(base)) {
            print(number / static_cast<unsigned long>(base), base);
        }
        put("0123456789ABCDEF"[number % static_cast<unsigned long>(base)]);
    }
    void print(long number)
    {
        if (number < 0) {
            put('-');
        }
        print(number < 0 ? 0ul - static_cast<unsigned long>(number) : static_cast<unsigned long>(number), DEC);
    }
    template <typename T> void println(T what)
    {
        print(what);
        println();
    }
    void println()
    {
        put('\n');
    }
};

static SerialPort Serial;

static inline void delay(unsigned long)
{
}

/* Each call takes a millisecond. */
static inline unsigned long millis()
{
    static unsigned long now = 0;
    return ++now;
}

void setup();
void loop();

int main()
{
    setup();
    loop();
    stop();
    return 0;
}

#endif
