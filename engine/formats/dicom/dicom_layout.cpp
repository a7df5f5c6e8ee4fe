#include "engine/formats/dicom/dicom_layout.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <string_view>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr int64_t PREAMBLE = 132;
constexpr uint32_t UNDEFINED = 0xffffffff;
constexpr int DEEPEST = 16;  ///< maximum depth of nested sequences; real files have about 5 levels

constexpr uint32_t TRANSFER_SYNTAX = 0x00020010;
constexpr uint32_t PIXEL_DATA = 0x7fe00010;
constexpr uint32_t FLOAT_PIXELS = 0x7fe00008, DOUBLE_PIXELS = 0x7fe00009;
constexpr uint32_t ITEM = 0xfffee000;
constexpr uint32_t END_OF_ITEM = 0xfffee00d;
constexpr uint32_t END_OF_SEQUENCE = 0xfffee0dd;

/// Value representations (PS3.5, 6.2): first those with a 4-byte length field, then those with a 2-byte length field.
constexpr std::string_view LONG_TYPES = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
constexpr std::string_view SHORT_TYPES = "AE AS AT CS DA DS DT FD FL IS LO LT PN SH SL SS ST TM UI UL US";

bool is_one_of(std::string_view type, std::string_view types)
{
    return types.find(type) != std::string_view::npos;
}

struct Encoding {
    bool states_types = true;  ///< "explicit VR"
    bool big_endian = false;
};

std::string name_of(uint32_t tag)
{
    return sentence("(", std::hex, std::setfill('0'), std::setw(4), tag >> 16, ",", std::setw(4), tag & 0xffff, ")");
}

class Walk {
public:
    explicit Walk(const InputFile& file) : file_(file) {}

    /// `at`: offset of the first element. `states_types`: whether elements state types, if there is no file meta group.
    DicomLayout run(int64_t at, bool states_types)
    {
        constexpr Encoding META{true, false};
        if (group_at(at) != 2) layout_.transfer_syntax = states_types ? "1.2.840.10008.1.2.1" : "1.2.840.10008.1.2";
        // The file meta group has a fixed encoding; the elements after it may use another.
        while (group_at(at) == 2) {
            const Element element = read_element(at, file_.bytes, META);
            if (element.length == UNDEFINED) refuse(element, "a length");
            if (element.tag == TRANSFER_SYNTAX) layout_.transfer_syntax = text(element);
            at = end_of(element, file_.bytes);
        }
        const std::string& syntax = layout_.transfer_syntax;
        if (syntax == "1.2.840.10008.1.2.1.99") {
            fail(file_.path.string(), ": transfer syntax is ", syntax,
                 ", which compresses the header as well; expected one that does not");
        }
        const Encoding encoding{syntax != "1.2.840.10008.1.2", syntax == "1.2.840.10008.1.2.2"};
        layout_.is_big_endian = encoding.big_endian;
        walk_elements(at, file_.bytes, encoding, 0, false);
        return layout_;
    }

private:
    struct Element {
        uint32_t tag = 0;
        std::array<char, 2> type{};
        uint32_t length = 0;
        int64_t value_at = 0;
    };

    [[noreturn]] void refuse(const Element& element, const std::string& expected) const
    {
        fail(file_.path.string(), ": element ", name_of(element.tag), " at byte ", element.value_at, " has length ",
             element.length, "; expected ", expected);
    }
    int64_t end_of(const Element& element, int64_t end) const
    {
        if (element.length > end - element.value_at) {
            refuse(element, sentence("at most ", end - element.value_at, ": the file or the item ends there"));
        }
        return element.value_at + element.length;
    }

    /// Refuses a delimiter with a nonzero length, because GDCM would read that many bytes as a value.
    int64_t after_delimiter(const Element& element) const
    {
        if (element.length != 0) refuse(element, "0, as of every end");
        return element.value_at;
    }

    uint32_t group_at(int64_t at) const
    {
        std::array<std::byte, 2> bytes{};
        return file_.read_some(at, bytes) == bytes.size() ? number(bytes.data(), 2, false) : 0;
    }
    uint32_t number(const std::byte* bytes, int count, bool big_endian) const
    {
        uint32_t value = 0;
        for (int i = 0; i < count; ++i) {
            value = value << 8 | std::to_integer<uint32_t>(bytes[big_endian ? i : count - 1 - i]);
        }
        return value;
    }

    Element read_element(int64_t at, int64_t end, const Encoding& encoding) const
    {
        std::array<std::byte, 12> bytes{};
        const size_t count = file_.read_some(at, std::span(bytes).first(size_t(std::min<int64_t>(12, end - at))));
        const auto need = [&](size_t needed) {
            if (count < needed)
                fail(file_.path.string(), ": ends within the element at byte ", at, "; expected all of it");
        };
        need(8);
        Element element;
        element.tag = number(&bytes[0], 2, encoding.big_endian) << 16 | number(&bytes[2], 2, encoding.big_endian);
        if (!encoding.states_types || element.tag >> 16 == 0xfffe) {
            element.length = number(&bytes[4], 4, encoding.big_endian);
            element.value_at = at + 8;
            return element;
        }
        element.type = {char(bytes[4]), char(bytes[5])};
        const std::string_view type(element.type.data(), 2);
        const auto is_letter = [](char character) { return character >= 'A' && character <= 'Z'; };
        if (!is_letter(type[0]) || !is_letter(type[1])) {
            fail(file_.path.string(), ": element ", name_of(element.tag), " at byte ", at,
                 " has no value representation; expected two letters, as its transfer syntax requires");
        }
        if (is_one_of(type, LONG_TYPES)) {
            need(12);
            element.length = number(&bytes[8], 4, encoding.big_endian);
            element.value_at = at + 12;
            return element;
        }
        // Refuses unknown types, because GDCM and this check would assume different sizes for the length field.
        if (!is_one_of(type, SHORT_TYPES)) {
            fail(file_.path.string(), ": element ", name_of(element.tag), " at byte ", at,
                 " has the value representation ", in_quotes(type), "; expected one that DICOM defines");
        }
        element.length = number(&bytes[6], 2, encoding.big_endian);
        element.value_at = at + 8;
        return element;
    }

    std::string text(const Element& element) const
    {
        std::string text(std::min<size_t>(element.length, 64), '\0');
        text.resize(file_.read_some(element.value_at, std::as_writable_bytes(std::span(text))));
        while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
        return text;
    }

    /// Checks elements up to `end`, or to the end of their item. Returns the offset of the next element.
    int64_t walk_elements(int64_t at, int64_t end, const Encoding& encoding, int depth, bool ends_by_delimiter)
    {
        constexpr int64_t A_TAG = 4;  // GDCM treats any bytes that hold a tag as an element, and then asserts
                                      // that the rest is valid
        while (at < end) {
            if (depth == 0 && end - at < A_TAG) return end;  // padding
            const Element element = read_element(at, end, encoding);
            if (element.tag == END_OF_ITEM && ends_by_delimiter) return after_delimiter(element);
            if (element.tag >> 16 == 0xfffe) refuse(element, "an element outside sequences");
            at = walk_value(element, end, encoding, depth);
        }
        if (ends_by_delimiter) fail(file_.path.string(), ": ends within a sequence; expected the end of the sequence");
        return at;
    }

    int64_t walk_value(const Element& element, int64_t end, const Encoding& encoding, int depth)
    {
        const bool is_float = element.tag == FLOAT_PIXELS || element.tag == DOUBLE_PIXELS;
        const bool is_pixels = (element.tag == PIXEL_DATA || is_float) && depth == 0;
        if (is_pixels && is_float) {
            layout_.numbers =
                element.tag == FLOAT_PIXELS ? DicomLayout::Numbers::float32 : DicomLayout::Numbers::float64;
            if (element.length == UNDEFINED) refuse(element, "a length, since floats are not compressed");
        }
        const bool is_unknown = std::string_view(element.type.data(), 2) == "UN";
        // The content of elements of type UN is in implicit little-endian encoding, in any file (PS3.5, 6.2.2).
        const Encoding inside = is_unknown ? Encoding{false, false} : encoding;
        if (element.length == UNDEFINED) {
            layout_.is_encapsulated |= is_pixels;
            return walk_items(element.value_at, end, inside, depth + 1, true, is_pixels);
        }
        const int64_t value_end = end_of(element, end);
        if (is_pixels) {
            layout_.pixel_bytes = element.length;
            layout_.pixels_at = element.value_at;
            layout_.pixels_are_words = std::string_view(element.type.data(), 2) == "OW";
        } else if (holds_items(element, encoding)) {
            walk_items(element.value_at, value_end, inside, depth + 1, false, false);
        }
        return value_end;
    }

    bool holds_items(const Element& element, const Encoding& encoding) const
    {
        std::array<std::byte, 4> start{};
        if (element.length < 8 || file_.read_some(element.value_at, start) < start.size()) return false;
        return (number(&start[0], 2, encoding.big_endian) << 16 | number(&start[2], 2, encoding.big_endian)) == ITEM;
    }

    /// Checks the items of a sequence, or the fragments of Pixel Data, up to `end` or to their delimiter.
    int64_t walk_items(int64_t at, int64_t end, const Encoding& encoding, int depth, bool ends_by_delimiter,
                       bool are_fragments)
    {
        if (depth > DEEPEST)
            fail(file_.path.string(), ": nests sequences more than ", DEEPEST,
                 " levels deep; expected at most that many");
        while (at < end) {
            const Element item = read_element(at, end, encoding);
            if (item.tag == END_OF_SEQUENCE && ends_by_delimiter) return after_delimiter(item);
            if (item.tag != ITEM) refuse(item, "an item of the sequence that contains it");
            if (item.length == UNDEFINED) {
                if (are_fragments) refuse(item, "a fragment with a length");
                at = walk_elements(item.value_at, end, encoding, depth, true);
                continue;
            }
            const int64_t item_end = end_of(item, end);
            if (are_fragments) {
                layout_.pixel_bytes += item.length;
                if (std::exchange(has_offsets_, true)) layout_.fragments.push_back({item.value_at, item.length});
            } else {
                walk_elements(item.value_at, item_end, encoding, depth, false);
            }
            at = item_end;
        }
        if (ends_by_delimiter) fail(file_.path.string(), ": ends within a sequence; expected the end of the sequence");
        return at;
    }

    const InputFile& file_;
    DicomLayout layout_;
    bool has_offsets_ = false;  ///< the first item of Pixel Data, the offset table, has been seen
};

}  // namespace

bool has_preamble(const InputFile& file)
{
    std::array<std::byte, 4> magic{};
    return file.read_some(PREAMBLE - 4, magic) == magic.size() &&
           magic == std::array{std::byte{'D'}, std::byte{'I'}, std::byte{'C'}, std::byte{'M'}};
}

namespace {

enum class Bare { no, with_types, without_types };

/// Whether a file without a preamble, as old programs wrote, begins like DICOM in little-endian order: with the first
/// elements of group 8 (no file meta group), or with the first elements of the file meta group.
Bare begins_bare(const InputFile& file)
{
    std::array<std::byte, 8> head{};
    if (file.read_some(0, head) < head.size()) return Bare::no;
    const auto byte = [&](size_t i) { return std::to_integer<uint32_t>(head[i]); };
    const uint32_t group = byte(0) | byte(1) << 8, element = byte(2) | byte(3) << 8;
    const bool is_first = group == 2 ? element <= 2 : group == 8 && element <= 0x20;
    if (!is_first) return Bare::no;
    const std::array<char, 2> type{char(byte(4)), char(byte(5))};
    const bool are_letters = type[0] >= 'A' && type[0] <= 'Z' && type[1] >= 'A' && type[1] <= 'Z';
    if (are_letters && is_one_of({type.data(), 2}, SHORT_TYPES)) return Bare::with_types;
    constexpr uint32_t LONGEST = 256;  // longest plausible value of the first elements
    const uint32_t length = byte(4) | byte(5) << 8 | byte(6) << 16 | byte(7) << 24;
    return group == 8 && length > 0 && length <= LONGEST && length % 2 == 0 ? Bare::without_types : Bare::no;
}

}  // namespace

bool begins_as_dicom(const InputFile& file)
{
    return has_preamble(file) || begins_bare(file) != Bare::no;
}

std::optional<DicomLayout> check_dicom_layout(const InputFile& file)
{
    if (has_preamble(file)) return Walk(file).run(PREAMBLE, true);
    const Bare bare = begins_bare(file);
    if (bare == Bare::no) return {};
    try {
        DicomLayout layout = Walk(file).run(0, bare == Bare::with_types);
        if (layout.pixel_bytes > 0) return layout;
    } catch (const Error&) {  // not DICOM after all: its first bytes only looked like an element
    }
    return {};
}

}  // namespace shvr
