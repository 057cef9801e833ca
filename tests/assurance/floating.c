/* Answers each line "OPERATION FACTOR ADDEND DIVISOR NUMERATOR DENOMINATOR NUMBER" with a status and a number. */
#include <inttypes.h>
#include <stdio.h>

#include "canwright_float.h"

static void answer(canwright_status_t status, uint64_t number)
{
    printf("%s %" PRIX64 "\n", canwright_status_name(status), status == CANWRIGHT_OK ? number : 0u);
}

int main(void)
{
    char operation;
    canwright_linear_t linear;
    uint64_t number;
    while (scanf(" %c %" SCNd64 " %" SCNd64 " %" SCNd64 " %" SCNd32 " %" SCNu32 " %" SCNx64, &operation,
               &linear.factor, &linear.addend, &linear.divisor, &linear.ratio.numerator, &linear.ratio.denominator,
               &number) == 7) {
        const double as_double = canwright_double_of_bits(number);
        const float as_float = canwright_float_of_bits((uint32_t)number);
        const int64_t as_signed = canwright_signed64(number, 64u);
        canwright_status_t status = CANWRIGHT_OK;
        int64_t nearest = 0;
        uint32_t bits = 0u;
        switch (operation) {
        case 's':
            number = canwright_bits_of_double(canwright_signed_to_double(as_signed, &linear));
            break;
        case 'S':
            number = canwright_bits_of_float(canwright_signed_to_float(as_signed, &linear));
            break;
        case 'u':
            number = canwright_bits_of_double(canwright_unsigned_to_double(number, &linear));
            break;
        case 'U':
            number = canwright_bits_of_float(canwright_unsigned_to_float(number, &linear));
            break;
        case 'n':
            status = canwright_signed_from_double(&nearest, as_double, &linear, INT64_MIN, INT64_MAX);
            number = (uint64_t)nearest;
            break;
        case 'N':
            status = canwright_signed_from_float(&nearest, as_float, &linear, INT64_MIN, INT64_MAX);
            number = (uint64_t)nearest;
            break;
        case 'm':
            status = canwright_unsigned_from_double(&number, as_double, &linear, 0u, UINT64_MAX);
            break;
        case 'M':
            status = canwright_unsigned_from_float(&number, as_float, &linear, 0u, UINT64_MAX);
            break;
        case 'v':
            number = canwright_bits_of_float(canwright_narrow_to_float(as_signed, &linear));
            break;
        case 'w': {
            const int64_t factor = (int64_t)canwright_magnitude(linear.factor);
            const int64_t limit = ((INT64_C(1) << 62) - (INT64_C(1) << 37) - factor) / factor;
            status = canwright_narrow_from_float(&nearest, as_float, &linear, -limit, limit);
            number = (uint64_t)nearest;
            break;
        }
        case 'a':
            number = canwright_bits_of_double(canwright_bits32_to_double((uint32_t)number, &linear));
            break;
        case 'A':
            number = canwright_bits_of_float(canwright_bits32_to_float((uint32_t)number, &linear));
            break;
        case 'b':
            number = canwright_bits_of_double(canwright_bits64_to_double(number, &linear));
            break;
        case 'B':
            number = canwright_bits_of_float(canwright_bits64_to_float(number, &linear));
            break;
        case 'c':
            status = canwright_bits32_from_double(&bits, as_double, &linear);
            number = bits;
            break;
        case 'C':
            status = canwright_bits32_from_float(&bits, as_float, &linear);
            number = bits;
            break;
        case 'd':
            status = canwright_bits64_from_double(&number, as_double, &linear);
            break;
        case 'D':
            status = canwright_bits64_from_float(&number, as_float, &linear);
            break;
        default:
            return 1;
        }
        answer(status, number);
    }
    return 0;
}
