/* Answers each line "OPERATION NUMBER ...", up to seven unsigned integers, with a status and a number. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "canwright_float.h"

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
        case 'd':
            status = canwright_bits64_from_float(
                &number, canwright_float_of_bits((uint32_t)given[0]), canwright_float_of_bits((uint32_t)given[0]));
            break;
        default:
            return 1;
        }
        printf("%s %" PRIX64 "\n", canwright_status_name(status), status == CANWRIGHT_OK ? number : 0u);
    }
    return 0;
}
