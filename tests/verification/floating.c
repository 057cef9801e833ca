/* Answers each line "OPERATION NUMBER ...", up to seven unsigned integers, with a status and a number. */

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "canwright_float.h"
static canwright_status_t from_double(char operation, const uint64_t *given, uint64_t *number)
{
    const double value = canwright_double_of_bits(given[0]);
    const double steps = canwright_double_of_bits(given[1]);
    int32_t narrow = 0;
    int64_t wide = 0;
    uint32_t single = 0u;
    canwright_status_t status;
    switch (operation) {
    case 'A':
        status = canwright_signed32_from_double(&narrow, value, steps, (int32_t)given[2], (int32_t)given[3]);
        *number = (uint64_t)narrow;
        return status;
    case 'B':
        status = canwright_signed64_from_double(&wide, value, steps, (int64_t)given[2], (int64_t)given[3]);
        *number = (uint64_t)wide;
        return status;
    case 'C':
        return canwright_unsigned64_from_double(number, value, steps, given[2], given[3]);
    case 'D':
        return canwright_bits64_from_double(number, value, steps);
    default:
        status = canwright_bits32_from_double(&single, value, steps);
        *number = single;
        return status;
    }
}

static canwright_status_t from_float(char operation, const uint64_t *given, uint64_t *number)
{
    const float value = canwright_float_of_bits((uint32_t)given[0]);
    const float steps = canwright_float_of_bits((uint32_t)given[1]);
    int32_t narrow = 0;
    int64_t wide = 0;
    uint32_t single = 0u;
    canwright_status_t status;
    switch (operation) {
    case 'G':
        status = canwright_signed32_from_float(&narrow, value, steps, (int32_t)given[2], (int32_t)given[3]);
        *number = (uint64_t)narrow;
        return status;
    case 'H':
        status = canwright_signed64_from_float(&wide, value, steps, (int64_t)given[2], (int64_t)given[3]);
        *number = (uint64_t)wide;
        return status;
    case 'I':
        return canwright_unsigned64_from_float(number, value, steps, given[2], given[3]);
    case 'J':
        return canwright_bits64_from_float(number, value, steps);
    default:
        status = canwright_bits32_from_float(&single, value, steps);
        *number = single;
        return status;
    }
}

static uint64_t of_ratio(char operation, const uint64_t *given)
{
    const canwright_ratio_t ratio = {(int32_t)given[2], (uint32_t)given[3]};
    const double one = canwright_double_of_bits(given[0]);
    const double other = canwright_double_of_bits(given[1]);
    const float single = canwright_float_of_bits((uint32_t)given[0]);
    const float other_single = canwright_float_of_bits((uint32_t)given[1]);
    switch (operation) {
    case 'M':
        return canwright_bits_of_double(canwright_multiple_double(&ratio, one, other));
    case 'N':
        return canwright_bits_of_double(canwright_share_double(one, &ratio));
    case 'O':
        return canwright_bits_of_float(canwright_multiple_float(&ratio, single, other_single));
    default:
        return canwright_bits_of_float(canwright_share_float(single, &ratio));
    }
}

int main(void)
{
    char line[200];
    while (fgets(line, (int)sizeof line, stdin) != NULL) {
        uint64_t given[7] = {0};
        char *next = line + 1;
        double value;
        double steps;
        canwright_status_t status = CANWRIGHT_OK;
        uint64_t number = 0u;
        int64_t nearest = 0;
        size_t i;
        for (i = 0u; i < 7u; i++) {
            given[i] = strtoull(next, &next, 10);
        }
        value = canwright_double_of_bits(given[0]);
        steps = canwright_double_of_bits(given[1]);
        switch (line[0]) {
        case 's':
            number = canwright_bits_of_double(canwright_quotient_signed(canwright_signed64(given[0], 64u), given[1]));
            break;
        case 'u':
            number = canwright_bits_of_double(canwright_quotient_unsigned(given[0], given[1]));
            break;
        case 'n':
            status = canwright_corrected_signed_from_double(
                &nearest, value, steps, given[2], given[3], given[4], (int64_t)given[5], (int64_t)given[6]);
            number = (uint64_t)nearest;
            break;
        case 'm':
            status = canwright_corrected_unsigned_from_double(
                &number, value, steps, given[2], given[3], given[4], given[5], given[6]);
            break;
        case 'f':
            number = canwright_bits_of_float(canwright_float_of_bits64(given[0]));
            break;
        default:
            if (line[0] >= 'M') {
                number = of_ratio(line[0], given);
            } else if (line[0] >= 'G') {
                status = from_float(line[0], given, &number);
            } else {
                status = from_double(line[0], given, &number);
            }
            break;
        }
        printf("%s %" PRIX64 "\n", canwright_status_name(status), status == CANWRIGHT_OK ? number : 0u);
    }
    return 0;
}
