#include "engine/formats/stored_numbers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

VoxelType wide_type(StoredNumber number)
{
    return number == StoredNumber::float16 ? VoxelType::float32 : VoxelType::float64;
}

double integer_of(StoredNumber number, uint64_t bits, const std::string& file)
{
    constexpr int64_t LARGEST = int64_t{1} << 53;
    const bool is_signed = number == StoredNumber::int64;
    const auto value = std::bit_cast<int64_t>(bits);
    if (value >= -LARGEST * int64_t{is_signed} && value <= LARGEST) return double(value);
    const std::string found = is_signed ? std::to_string(value) : std::to_string(bits);
    fail(file, ": holds ", found, " as ", name_of(number), "; expected at most ", LARGEST,
         is_signed ? ", with either sign," : "", " up to which float64 holds every whole number");
}

VolumeInfo widened_info(VolumeInfo info, StoredNumber number)
{
    info.type = wide_type(number);
    info.warnings.push_back(sentence("its ", name_of(number), " values are read as ", name_of(info.type)));
    return info;
}

class WidenedSource final : public VolumeSource {
public:
    WidenedSource(std::unique_ptr<VolumeSource> source, StoredNumber number, std::string file)
        : VolumeSource(widened_info(source->info(), number)),
          source_(std::move(source)),
          number_(number),
          file_(std::move(file))
    {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    Size3 block() const override { return source_->block(); }
    int levels() const override { return source_->levels(); }

    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (number_ != StoredNumber::float16) {
            source_->read_level(level, box, voxels);
            return widen_integers(number_, voxels, file_);
        }
        // Reads the stored numbers into the second half of the output, since they take half the space. Conversion
        // proceeds from the front, so it never overwrites a stored number that is still needed.
        const size_t count = voxels.size() / sizeof(float);
        const std::span<std::byte> halves = voxels.last(count * sizeof(uint16_t));
        source_->read_level(level, box, halves);
        for (size_t i = 0; i < count; ++i) {
            uint16_t half = 0;
            std::memcpy(&half, halves.data() + i * sizeof(half), sizeof(half));
            const float value = float_of_half(half);
            std::memcpy(voxels.data() + i * sizeof(value), &value, sizeof(value));
        }
    }

    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        std::optional<StoredBlocks> stored = source_->stored_blocks(level, most);
        if (!stored) return stored;
        stored->fill = number_ == StoredNumber::float16
                           ? double(float_of_half(uint16_t(stored->fill)))
                           : integer_of(number_, std::bit_cast<uint64_t>(stored->fill), file_);
        return stored;
    }

private:
    std::unique_ptr<VolumeSource> source_;
    StoredNumber number_;
    std::string file_;
};

}  // namespace

const char* name_of(StoredNumber number)
{
    switch (number) {
        case StoredNumber::plain: return "plain";
        case StoredNumber::int64: return "int64";
        case StoredNumber::uint64: return "uint64";
        case StoredNumber::float16: return "float16";
    }
    return "";
}

std::optional<StoredNumber> wide_integer_of(std::string_view name)
{
    // Makes both spellings equal: NRRD separates words by spaces, MetaImage by underscores, after the prefix "MET_".
    std::string spaced = lower_case(std::string(name));
    std::replace(spaced.begin(), spaced.end(), '_', ' ');
    std::string plain;
    for (const std::string_view word : words_of(spaced)) {
        if (word == "met" && plain.empty()) continue;
        plain += plain.empty() ? "" : " ";
        plain += word;
    }
    for (const char* known :
         {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64 t"}) {
        if (plain == known) return StoredNumber::int64;
    }
    for (const char* known :
         {"ulonglong", "ulong long", "unsigned long long", "unsigned long long int", "uint64", "uint64 t"}) {
        if (plain == known) return StoredNumber::uint64;
    }
    return {};
}

VoxelType bits_type(StoredNumber number)
{
    return number == StoredNumber::float16 ? VoxelType::uint16 : VoxelType::float64;
}

float float_of_half(uint16_t half)
{
    const int exponent = half >> 10 & 31;
    const int fraction = half & 1023;
    const float sign = (half & 0x8000) != 0 ? -1.0F : 1.0F;
    if (exponent == 31) return fraction == 0 ? sign * INFINITY : NAN;
    if (exponent == 0) return sign * std::ldexp(float(fraction), -24);
    return sign * std::ldexp(float(fraction + 1024), exponent - 25);
}

std::optional<uint16_t> half_of(double value)
{
    constexpr int INFINITE = 31 << 10;
    const int sign = std::signbit(value) ? 0x8000 : 0;
    if (std::isnan(value)) return uint16_t(INFINITE | 1 << 9);
    const double size = std::abs(value);
    if (std::isinf(size)) return uint16_t(sign | INFINITE);
    const int exponent = size > 0.0 ? std::max(std::ilogb(size), -14) : -14;
    if (exponent > 15) return std::nullopt;
    // A fraction that is rounded up to 2048 must carry into the exponent: adding, as below, does this.
    const int fraction = int(std::nearbyint(std::ldexp(size, 10 - exponent)));
    const int bits = ((exponent + 14) << 10) + fraction;
    if (bits >= INFINITE) return std::nullopt;
    return uint16_t(sign | bits);
}

void widen_integers(StoredNumber number, std::span<std::byte> voxels, const std::string& file)
{
    for (size_t at = 0; at < voxels.size(); at += sizeof(uint64_t)) {
        uint64_t bits = 0;
        std::memcpy(&bits, voxels.data() + at, sizeof(bits));
        const double value = integer_of(number, bits, file);
        std::memcpy(voxels.data() + at, &value, sizeof(value));
    }
}

std::unique_ptr<VolumeSource> widened(std::unique_ptr<VolumeSource> source, StoredNumber number,
                                      const std::string& file)
{
    if (number == StoredNumber::plain) return source;
    SHVR_CHECK(source->info().type == bits_type(number));
    return std::make_unique<WidenedSource>(std::move(source), number, file);
}

}  // namespace shvr
