/* Decides for all 65,536 percepts of 16 bits, or with a memory in episodes on its own charts, and prints
   a checksum (CRC-16) of the actions: on an AVR through its serial port, elsewhere to standard output. */
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

#if defined(XCSCR_STATES)
static uint16_t drawn(uint16_t below)
{
    static uint32_t seed = 1;
    seed = seed * 1664525u + 1013904223u;
    return (uint16_t)((seed >> 16) % below);
}

/* 200 episodes; one percept in 16 has a wrong bit. */
static uint16_t decided(uint16_t crc)
{
    static struct xcscr_tracker tracker;
    uint8_t episode;

    for (episode = 0; episode < 200; episode++) {
        uint16_t at = drawn(XCSCR_STATES);
        uint8_t step;
        int bumped = 0;
        xcscr_reset(&tracker);
        for (step = 0; step < 50 && at != XCSCR_GOAL; step++) {
            const uint16_t wrong = drawn(16) == 0 ? (uint16_t)(1u << drawn(16)) : 0;
            const uint16_t percept = xcscr_state(at).percept ^ wrong;
            const uint16_t before = at;
            crc = followed(crc, (uint8_t)xcscr_perceive(&tracker, percept, bumped, 0));
            if (tracker.action == XCSCR_NO_ACTION) {
                tracker.action = (int8_t)drawn(XCSCR_ACTIONS);
            }
            at = xcscr_state(at).next[tracker.action];
            bumped = at == before;
        }
    }
    return crc;
}
#else
static uint16_t decided(uint16_t crc)
{
    uint32_t word;

    for (word = 0; word < 65536u; word++) {
        const uint8_t percept[XCSCR_PERCEPT_BYTES] = {(uint8_t)(word & 0xffu), (uint8_t)(word >> 8)};
        crc = followed(crc, (uint8_t)xcscr_decide(percept));
    }
    return crc;
}
#endif

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
