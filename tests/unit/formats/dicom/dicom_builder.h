#pragma once
// DICOM files that tests make, element by element, and the slices of a small phantom.

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"

namespace shvr::test {

inline constexpr const char* EXPLICIT_LITTLE = "1.2.840.10008.1.2.1";
inline constexpr const char* IMPLICIT_LITTLE = "1.2.840.10008.1.2";
inline constexpr const char* EXPLICIT_BIG = "1.2.840.10008.1.2.2";

/// The phantom's voxel at x, y, z.
inline int phantom(int64_t x, int64_t y, int64_t z)
{
    return int(x + 10 * y + 100 * z - 99);
}

inline std::string little(uint64_t number, size_t bytes)
{
    std::string text;
    for (size_t i = 0; i < bytes; ++i) text += char(number >> (8 * i) & 255);
    return text;
}

struct Value {
    std::string type;
    std::string bytes;
};

/// Builds a DICOM file, element by element (PS3.5, 7.1). Values are given in little-endian order.
struct Dicom {
    std::string transfer_syntax = EXPLICIT_LITTLE;
    std::map<uint32_t, Value> elements{};

    Dicom& text(uint32_t tag, const char* type, std::string value)
    {
        if (value.size() % 2 == 1) value += std::string_view(type) == "UI" ? '\0' : ' ';
        elements[tag] = {type, value};
        return *this;
    }
    Dicom& number(uint32_t tag, uint16_t value)
    {
        elements[tag] = {"US", little(value, 2)};
        return *this;
    }
    /// Adds a sequence of one item with `values`, or of several.
    Dicom& sequence(uint32_t tag, const std::vector<Dicom>& items)
    {
        std::string bytes;
        for (const Dicom& item : items) {
            const std::string content = item.data_set();
            bytes += little(0xfffe, 2) + little(0xe000, 2) + little(content.size(), 4) + content;
        }
        elements[tag] = {"SQ", bytes};
        return *this;
    }

    std::string element(uint32_t tag, const Value& value, bool is_explicit, bool big) const
    {
        const auto ordered = [&](uint64_t number, size_t bytes) {
            std::string text = little(number, bytes);
            if (big) std::reverse(text.begin(), text.end());
            return text;
        };
        std::string bytes = value.bytes;
        if (big && (value.type == "US" || value.type == "OW")) {
            for (size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
        }
        const std::string start = ordered(tag >> 16, 2) + ordered(tag & 0xffff, 2);
        if (!is_explicit) return start + ordered(bytes.size(), 4) + bytes;
        const bool is_long = std::string_view("OW OB OF OD SQ UN").find(value.type) != std::string_view::npos;
        return start + value.type +
               (is_long ? std::string(2, '\0') + ordered(bytes.size(), 4) : ordered(bytes.size(), 2)) + bytes;
    }
    std::string data_set() const
    {
        std::string bytes;
        for (const auto& [tag, value] : elements) {
            bytes += element(tag, value, transfer_syntax != IMPLICIT_LITTLE, transfer_syntax == EXPLICIT_BIG);
        }
        return bytes;
    }
    std::string file() const
    {
        Dicom meta;
        meta.text(0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.2").text(0x00020003, "UI", "1.2.3");
        meta.text(0x00020010, "UI", transfer_syntax);
        const std::string group = meta.data_set();
        return std::string(128, '\0') + "DICM" + element(0x00020000, {"UL", little(group.size(), 4)}, true, false) +
               group + data_set();
    }
};

inline constexpr uint32_t POSITION = 0x00200032;
inline constexpr uint32_t ORIENTATION = 0x00200037;
inline constexpr uint32_t SPACING = 0x00280030;
inline constexpr uint32_t INTERCEPT = 0x00281052;
inline constexpr uint32_t SLOPE = 0x00281053;
inline constexpr uint32_t PIXELS = 0x7fe00010;

/// A CT image of 5 x 4 pixels, slice `z` of the phantom, without a position.
inline Dicom image_of(int64_t z)
{
    Dicom dicom;
    dicom.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2").text(0x00080018, "UI", sentence("1.2.3.", z + 1));
    dicom.text(0x00080060, "CS", "CT").text(0x0008103e, "LO", "Axial").text(0x0020000d, "UI", "1.2.8");
    dicom.text(0x0020000e, "UI", "1.2.9").text(0x00200011, "IS", "3").text(0x00200013, "IS", std::to_string(z + 1));
    dicom.number(0x00280002, 1).text(0x00280004, "CS", "MONOCHROME2").number(0x00280010, 4).number(0x00280011, 5);
    dicom.number(0x00280100, 16).number(0x00280101, 16).number(0x00280102, 15).number(0x00280103, 1);
    std::string pixels;
    for (int64_t i = 0; i < 20; ++i) pixels += little(uint16_t(phantom(i % 5, i / 5, z)), 2);
    dicom.elements[PIXELS] = {"OW", pixels};
    return dicom;
}

/// The same with its first pixel at 10, 20, 30 + 1.25 z mm.
inline Dicom slice_of(int64_t z)
{
    Dicom dicom = image_of(z);
    dicom.text(POSITION, "DS", sentence("10\\20\\", 30.0 + 1.25 * double(z)));
    dicom.text(ORIENTATION, "DS", "1\\0\\0\\0\\1\\0").text(SPACING, "DS", "0.5\\0.5");
    return dicom;
}

}  // namespace shvr::test
