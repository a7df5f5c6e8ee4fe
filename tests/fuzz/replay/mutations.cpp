#include "tests/fuzz/replay/mutations.h"

#include <algorithm>
#include <random>
#include <set>

namespace shvr::fuzz {
namespace {

constexpr size_t MAX_INPUT_BYTES = size_t{1} << 18;
/// Most formats have their important fields at the beginning.
constexpr size_t HEAD_BYTES = 400;

constexpr uint64_t NUMBERS[] = {0,
                                1,
                                2,
                                3,
                                0x7f,
                                0x80,
                                0xff,
                                0x100,
                                0x7fff,
                                0x8000,
                                0xffff,
                                0x10000,
                                0x100000,
                                0x100001,
                                0x7fffffff,
                                0x80000000,
                                0xffffffff,
                                0xfffffffe,
                                0x100000000,
                                0x7fffffffffffffff,
                                0x8000000000000000,
                                0xffffffffffffffff,
                                0xfffffffffffffff0,
                                0x7ff0000000000000,  // infinity
                                0x7ff8000000000000,  // NaN
                                0x7f800000,
                                0x7fc00000,
                                0x0000000000000001};
constexpr const char* TEXTS[] = {"0",
                                 "-1",
                                 "1",
                                 "2",
                                 "3",
                                 "65536",
                                 "1048576",
                                 "1048577",
                                 "2147483647",
                                 "2147483648",
                                 "4294967296",
                                 "9223372036854775807",
                                 "9223372036854775808",
                                 "18446744073709551616",
                                 "-9223372036854775808",
                                 "1e308",
                                 "-1e308",
                                 "1e-320",
                                 "0.5",
                                 "nan",
                                 "inf",
                                 "-0",
                                 "1e18",
                                 "\"",
                                 "[]",
                                 "{}",
                                 "null",
                                 "%",
                                 ""};

class Changes {
public:
    Changes(std::string_view seed, std::string_view other, uint64_t number)
        : bytes_(seed), other_(other), random_(number * 0x9e3779b97f4a7c15ull + seed.size())
    {}

    std::string make()
    {
        const size_t count = 1 + below(3);
        for (size_t i = 0; i < count; ++i) change();
        if (bytes_.size() > MAX_INPUT_BYTES) bytes_.resize(MAX_INPUT_BYTES);
        return bytes_;
    }

private:
    /// Distributions of the standard library differ between machines.
    size_t below(size_t end) { return end == 0 ? 0 : size_t(random_() % end); }
    size_t place() { return below(below(2) == 0 ? std::min(bytes_.size(), HEAD_BYTES) : bytes_.size()); }

    void change()
    {
        switch (below(8)) {
            case 0: return flip();
            case 1: return set_integer();
            case 2: return double_integer();
            case 3:
            case 4: return exchange_number();
            case 5: return double_part();
            case 6: return take_out();
            case 7: return splice();
        }
    }
    void flip()
    {
        if (bytes_.empty()) return;
        char& byte = bytes_[place()];
        byte = char(byte ^ (1 << below(8)));
    }
    void set_integer()
    {
        const uint64_t value = NUMBERS[below(std::size(NUMBERS))];
        const size_t width = size_t{1} << below(4);
        const size_t at = place();
        const bool is_big = below(2) == 0;
        for (size_t i = 0; i < width && at + i < bytes_.size(); ++i) {
            bytes_[at + i] = char(value >> 8 * (is_big ? width - 1 - i : i) & 0xff);
        }
    }
    void double_integer()
    {
        const size_t at = place();
        if (at + 4 > bytes_.size()) return;
        uint32_t value = 0;
        for (size_t i = 4; i-- > 0;) value = value << 8 | uint8_t(bytes_[at + i]);
        value *= 2;
        for (size_t i = 0; i < 4; ++i) bytes_[at + i] = char(value >> 8 * i & 0xff);
    }
    void exchange_number()
    {
        const size_t begin = bytes_.find_first_of("0123456789", place());
        if (begin == std::string::npos) return flip();
        const size_t end = std::min(bytes_.size(), bytes_.find_first_not_of("0123456789.", begin));
        bytes_.replace(begin, end - begin, TEXTS[below(std::size(TEXTS))]);
    }
    void double_part()
    {
        const size_t at = place();
        const std::string part = bytes_.substr(at, 1 + below(64));
        bytes_.insert(at, part);
    }
    void take_out()
    {
        const size_t at = place();
        // A whole line, if the seed is text.
        if (below(2) == 0) {
            const size_t end = std::min(bytes_.size(), bytes_.find('\n', at));
            bytes_.erase(at, std::min(end - at + 1, size_t{200}));
        } else {
            bytes_.erase(at, 1 + below(32));
        }
    }
    void splice()
    {
        if (other_.empty()) return flip();
        const size_t from = below(other_.size());
        const std::string_view part = other_.substr(from, 1 + below(128));
        const size_t at = place();
        bytes_.replace(at, below(2) == 0 ? part.size() : 0, part);
    }

    std::string bytes_;
    std::string_view other_;
    std::mt19937_64 random_;
};

}  // namespace

std::vector<size_t> cuts_of(size_t length, size_t most)
{
    std::set<size_t> cuts;
    if (length <= most) {
        for (size_t cut = 0; cut < length; ++cut) cuts.insert(cut);
    } else {
        for (size_t i = 0; i < most / 2; ++i) cuts.insert(i * length / (most / 2));
        for (size_t i = 0; i < most / 2; ++i) cuts.insert(i * std::min(length, 2 * HEAD_BYTES) / (most / 2));
    }
    return {cuts.begin(), cuts.end()};
}

std::vector<std::string> nested(std::string_view seed)
{
    constexpr size_t MAX_VALUES = 16;
    constexpr size_t DEPTH = 50000;
    static const std::string deep = std::string(DEPTH, '[') + std::string(DEPTH, ']');
    std::vector<std::string> inputs;
    for (size_t at = seed.find("\":"); at != std::string_view::npos && inputs.size() < MAX_VALUES;
         at = seed.find("\":", at + 2)) {
        inputs.push_back(std::string(seed.substr(0, at + 2)) + deep + ", \"x\":" + std::string(seed.substr(at + 2)));
    }
    return inputs;
}

std::string mutated(std::string_view seed, std::string_view other, uint64_t number)
{
    return Changes(seed, other, number).make();
}

}  // namespace shvr::fuzz
