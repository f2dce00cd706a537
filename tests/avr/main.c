/* Decides for all 65,536 percepts of 16 bits, and prints a checksum (CRC-16) of the actions: on an AVR
   through its serial port, elsewhere to standard output. */
#include "policy.h"

#if defined(__AVR__)
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

static void put(char letter)
{
    while (!(UCSR0A & (1 << UDRE0))) {
    }
    UDR0 = (uint8_t)letter;
}

static void begin(void)
{
    UCSR0B = 1 << TXEN0;
}

static void end(void)
{
    while (!(UCSR0A & (1 << UDRE0))) {
    }
    cli();
    sleep_enable();
    sleep_cpu();
}
#else
#include <stdio.h>

static void put(char letter)
{
    putchar(letter);
}

static void begin(void)
{
}

static void end(void)
{
}
#endif

static uint16_t followed(uint16_t crc, uint8_t byte)
{
    uint8_t bit;
    crc = (uint16_t)(crc ^ (uint16_t)(byte << 8));
    for (bit = 0; bit < 8; bit++) {
        const uint16_t shifted = (uint16_t)(crc << 1);
        crc = (crc & 0x8000u) != 0 ? (uint16_t)(shifted ^ 0x1021u) : shifted;
    }
    return crc;
}

static uint16_t decided(uint16_t crc)
{
    uint32_t word;

    for (word = 0; word < 65536u; word++) {
        const uint8_t percept[XCSCR_PERCEPT_BYTES] = {(uint8_t)(word & 0xffu), (uint8_t)(word >> 8)};
        crc = followed(crc, (uint8_t)xcscr_decide(percept));
    }
    return crc;
}

int main(void)
{
    static const char digits[] = "0123456789abcdef";
    uint16_t crc;
    int8_t shift;

    begin();
    crc = decided(0xffffu);
    for (shift = 12; shift >= 0; shift = (int8_t)(shift - 4)) {
        put(digits[(crc >> shift) & 15]);
    }
    put('\n');
    end();
    return 0;
}
