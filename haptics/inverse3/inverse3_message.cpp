#include "haptics/inverse3/inverse3_message.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace shvr {
namespace {

constexpr int MAX_DEPTH = 24;
constexpr size_t MAX_ID = 64;
constexpr double MAX_PLACE_M = 10.0;  ///< no device reaches farther

/// Parses JSON in one pass. After the first error, which is kept, nothing more is parsed.
class Scanner {
public:
    explicit Scanner(std::string_view text) : rest_(text) {}
    const char* trouble() const { return trouble_; }
    bool refuse(const char* why)
    {
        if (!trouble_) trouble_ = why;
        return false;
    }

    /// Calls `member(key)` for each member of an object; `member` must read the value.
    template <class Member>
    bool object(const Member& member)
    {
        return nested('{', '}', [&] {
            std::string_view key;
            if (!string(key) || !sign(':')) return false;
            return member(key);
        });
    }
    /// Calls `element()` for each element of an array; `element` must read the element.
    template <class Element>
    bool array(const Element& element)
    {
        return nested('[', ']', element);
    }
    /// Reads a string without decoding its escapes.
    bool string(std::string_view& text)
    {
        if (!sign('"')) return false;
        size_t end = 0;
        while (end < rest_.size() && rest_[end] != '"') {
            if (uint8_t(rest_[end]) < 0x20) return refuse("a text with control characters");
            end += rest_[end] == '\\' ? 2 : 1;
        }
        if (end >= rest_.size()) return refuse(CUT);
        text = rest_.substr(0, end);
        rest_.remove_prefix(end + 1);
        return true;
    }
    bool number(double& value)
    {
        skip_space();
        const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
        const bool begins_well = !rest_.empty() && (rest_[0] == '-' || (rest_[0] >= '0' && rest_[0] <= '9'));
        if (rest_.empty()) return refuse(CUT);
        if (!begins_well || error == std::errc::invalid_argument) return refuse("no number where one is expected");
        if (error != std::errc() || !std::isfinite(value)) return refuse("a number that is not finite");
        rest_.remove_prefix(size_t(end - rest_.data()));
        return true;
    }
    bool flag(bool& value)
    {
        value = begins_with("true");
        return value ? word("true") : word("false");
    }
    /// Reads and drops any value.
    bool skip()
    {
        skip_space();
        if (rest_.empty()) return refuse(CUT);
        std::string_view text;
        double value = 0.0;
        switch (rest_[0]) {
            case '{': return object([&](std::string_view) { return skip(); });
            case '[': return array([&] { return skip(); });
            case '"': return string(text);
            case 't': return word("true");
            case 'f': return word("false");
            case 'n': return word("null");
            default: return number(value);
        }
    }
    char peek()
    {
        skip_space();
        return rest_.empty() ? char(0) : rest_[0];
    }
    bool end()
    {
        skip_space();
        return rest_.empty() || refuse("more after its end");
    }

private:
    static constexpr const char* CUT = "it ends too early";

    void skip_space()
    {
        while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\n' || rest_[0] == '\r' || rest_[0] == '\t'))
            rest_.remove_prefix(1);
    }
    bool begins_with(std::string_view text)
    {
        skip_space();
        return rest_.starts_with(text);
    }
    bool word(std::string_view text)
    {
        if (!begins_with(text)) return refuse(text.starts_with(rest_) ? CUT : "a value that is not JSON");
        rest_.remove_prefix(text.size());
        return true;
    }
    bool sign(char wanted)
    {
        if (peek() != wanted) return refuse(rest_.empty() ? CUT : "a value of another type than expected");
        rest_.remove_prefix(1);
        return true;
    }
    template <class Part>
    bool nested(char opening, char closing, const Part& part)
    {
        if (trouble_ || !sign(opening)) return false;
        if (++depth_ > MAX_DEPTH) return refuse("values that nest too deep");
        for (bool is_first = true; peek() != closing; is_first = false) {
            if (!is_first && !sign(',')) return false;
            if (!part() || trouble_) return false;
        }
        --depth_;
        return sign(closing);
    }

    std::string_view rest_;
    int depth_ = 0;
    const char* trouble_ = nullptr;
};

bool is_id(std::string_view text)
{
    return !text.empty() && text.size() <= MAX_ID && std::ranges::all_of(text, [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' || c == '_';
    });
}

/// Reads an object with one number per character of `keys`, such as "xyz"; all of them must be present.
template <size_t SIZE>
bool read_components(Scanner& scanner, std::string_view keys, std::array<double, SIZE>& values)
{
    uint32_t seen = 0;
    const bool is_read = scanner.object([&](std::string_view key) {
        const size_t index = key.size() == 1 ? keys.find(key[0]) : std::string_view::npos;
        if (index >= SIZE) return scanner.skip();
        seen |= 1u << index;
        return scanner.number(values[index]);
    });
    return is_read && (seen == (1u << SIZE) - 1 || scanner.refuse("a vector that lacks a component"));
}

bool read_place(Scanner& scanner, Inverse3State& state)
{
    std::array<double, 3> xyz{};
    if (!read_components(scanner, "xyz", xyz)) return false;
    state.position_m = {xyz[0], xyz[1], xyz[2]};
    state.has_position = true;
    const glm::dvec3 reach = glm::abs(state.position_m);
    return std::max({reach.x, reach.y, reach.z}) <= MAX_PLACE_M || scanner.refuse("a place that no device reaches");
}

bool read_device(Scanner& scanner, std::string_view wanted_id, Inverse3State& state)
{
    Inverse3State device;
    const bool is_read = scanner.object([&](std::string_view key) {
        if (key == "device_id") {
            std::string_view id;
            if (!scanner.string(id)) return false;
            device.device_id = id;
            return is_id(id) || scanner.refuse("a device_id with other signs than letters, digits, - and _");
        }
        if (key != "state") return scanner.skip();
        return scanner.object([&](std::string_view name) {
            return name == "cursor_position" ? read_place(scanner, device) : scanner.skip();
        });
    });
    if (!is_read) return false;
    if (device.device_id.empty()) return scanner.refuse("a device without device_id");
    const bool is_wanted = wanted_id.empty() ? state.device_id.empty() : device.device_id == wanted_id;
    if (!is_wanted) return true;
    state.device_id = device.device_id;
    state.has_position = device.has_position;
    state.position_m = device.position_m;
    return true;
}

bool read_buttons(Scanner& scanner, Inverse3State& state)
{
    return scanner.object([&](std::string_view key) {
        const uint32_t bit = key == "a" || key == "button_0" ? 1u : key == "b" || key == "button_1" ? 2u : 0u;
        if (bit == 0) return scanner.skip();
        bool is_down = false;
        if (!scanner.flag(is_down)) return false;
        state.buttons |= is_down ? bit : 0u;
        return true;
    });
}

bool read_grip(Scanner& scanner, Inverse3State& state)
{
    return scanner.object([&](std::string_view key) {
        if (key != "state") return scanner.skip();
        return scanner.object([&](std::string_view name) {
            if (name == "buttons" && scanner.peek() == '{') return read_buttons(scanner, state);
            if (name != "orientation") return scanner.skip();
            std::array<double, 4> wxyz{};
            if (!read_components(scanner, "wxyz", wxyz)) return false;
            const glm::dquat q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
            const double square = glm::dot(q, q);
            if (!(square > 0.25 && square < 4.0)) return true;  // not yet known
            const glm::dvec3 axis = from_inverse3({q.x, q.y, q.z});
            state.has_rotation = true;
            state.rotation = glm::normalize(glm::dquat(q.w, axis.x, axis.y, axis.z));
            return true;
        });
    });
}

/// Appends the shortest text that parses back to the same number.
void append_number(std::string& text, double value)
{
    std::array<char, 32> digits{};
    text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

}  // namespace

const char* read_inverse3_state(std::string_view text, std::string_view device_id, Inverse3State& state)
{
    state = {};
    Scanner scanner(text);
    bool has_grip = false;
    scanner.object([&](std::string_view key) {
        if (key == "inverse3") return scanner.array([&] { return read_device(scanner, device_id, state); });
        const bool is_grip = key == "wireless_verse_grip" || key == "verse_grip";
        if (!is_grip) return scanner.skip();
        // A state may list several grips; the first is the one in the user's hand. The others are skipped.
        return scanner.array(
            [&] { return std::exchange(has_grip, true) ? scanner.skip() : read_grip(scanner, state); });
    });
    if (!scanner.trouble()) scanner.end();
    if (!scanner.trouble() && !state.device_id.empty() && !state.has_position)
        scanner.refuse("a state without cursor_position");
    return scanner.trouble();
}

const char* read_inverse3_notice(std::string_view text, Inverse3Notice& notice)
{
    notice = {};
    Scanner scanner(text);
    std::string_view name, safety, id;
    scanner.object([&](std::string_view key) {
        if (key == "name") return scanner.string(name);
        if (key != "data" || scanner.peek() != '{') return scanner.skip();
        return scanner.object([&](std::string_view each) {
            if (scanner.peek() != '"') return scanner.skip();
            return each == "safety_type" ? scanner.string(safety)
                   : each == "device_id" ? scanner.string(id)
                                         : scanner.skip();
        });
    });
    if (!scanner.trouble()) scanner.end();
    if (scanner.trouble()) return scanner.trouble();
    notice.device_id = id;
    using enum Inverse3Event;
    const bool is_safety = name == "device-safety-triggered";
    notice.event = name == "device-connected"                   ? connected
                   : name == "device-disconnected"              ? disconnected
                   : is_safety && safety == "ebrake_triggered"  ? ebrake_on
                   : is_safety && safety == "ebrake_released"   ? ebrake_off
                   : is_safety && safety == "stall_detected"    ? stall
                   : is_safety && safety == "stability_ceiling" ? ceiling
                                                                : other;
    return nullptr;
}

void append_inverse3_command(std::string& text, std::string_view device_id, const glm::dvec3& force_n, bool is_first)
{
    text += '{';
    if (is_first) text += R"("session":{"configure":{"profile":{"name":"shvr"}}},)";
    text += R"("inverse3":[{"device_id":")";
    text += device_id;
    text += R"(","commands":{"set_cursor_force":{"vector":{"x":)";
    append_number(text, force_n.x);
    text += R"(,"y":)";
    append_number(text, force_n.y);
    text += R"(,"z":)";
    append_number(text, force_n.z);
    text += "}}}}]}";
}

}  // namespace shvr
