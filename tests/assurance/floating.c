/* Answers each line "OPERATION NUMBER NUMBER NUMBER NUMBER NUMBER", unsigned integers, with a status and a number. */
#include <inttypes.h>
#include <stdio.h>

#include "canwright_float.h"

int main(void)
{
    char operation;
    uint64_t given[5];
    while (scanf(" %c %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64 " %" SCNu64, &operation, &given[0], &given[1],
               &given[2], &given[3], &given[4]) == 6) {
        const double value = canwright_double_of_bits(given[0]);
        const double steps = canwright_double_of_bits(given[1]);
        canwright_status_t status = CANWRIGHT_OK;
        uint64_t number = 0u;
        int64_t nearest = 0;
        switch (operation) {
        case 's':
            number = canwright_bits_of_double(canwright_quotient_signed(canwright_signed64(given[0], 64u), given[1]));
            break;
        case 'u':
            number = canwright_bits_of_double(canwright_quotient_unsigned(given[0], given[1]));
            break;
        case 'n':
            status = canwright_corrected_signed_from_double(
                &nearest, value, steps, given[2], given[3], given[4], INT64_MIN, INT64_MAX);
            number = (uint64_t)nearest;
            break;
        case 'm':
            status = canwright_corrected_unsigned_from_double(
                &number, value, steps, given[2], given[3], given[4], 0u, UINT64_MAX);
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
