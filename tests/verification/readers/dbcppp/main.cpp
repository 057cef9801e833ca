// Decodes frames with dbcppp: FILE, then lines ID#DATA in hexadecimal on standard input.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>

#include <dbcppp/Network.h>

int main(int, char** argv)
{
    std::ifstream file(argv[1]);
    const auto network = dbcppp::INetwork::LoadDBCFromIs(file);
    if (!network)
    {
        std::cerr << "the file is not supported\n";
        return EXIT_FAILURE;
    }
    std::cout.precision(std::numeric_limits<double>::max_digits10);
    std::string frame;
    while (std::cin >> frame)
    {
        const auto separator = frame.find('#');
        const auto id = std::stoul(frame.substr(0, separator), nullptr, 16);
        const auto hex = frame.substr(separator + 1);
        std::array<std::uint8_t, 64> data{};
        for (std::size_t i = 0; i < hex.size() / 2; i++)
        {
            data[i] = static_cast<std::uint8_t>(std::stoul(hex.substr(2 * i, 2), nullptr, 16));
        }
        for (const auto& message : network->Messages())
        {
            if (message.Id() != id)
            {
                continue;
            }
            const auto* selector = message.MuxSignal();
            for (const auto& signal : message.Signals())
            {
                if (signal.MultiplexerIndicator() != dbcppp::ISignal::EMultiplexer::MuxValue
                    || (selector && signal.MultiplexerSwitchValue() == selector->Decode(data.data())))
                {
                    std::cout << signal.Name() << '=' << signal.RawToPhys(signal.Decode(data.data())) << ' ';
                }
            }
        }
        std::cout << '\n';
    }
    return EXIT_SUCCESS;
}
