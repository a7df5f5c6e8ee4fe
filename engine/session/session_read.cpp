// Reads session files.

#include <algorithm>
#include <climits>

#include "engine/base/text.h"
#include "engine/look/session_color.h"
#include "engine/remote/address.h"
#include "engine/session/session_keys.h"

namespace shvr {
namespace {

/// Collects the keys that an object may have. Reads a value only if it decides which other keys are valid.
class KnownKeys : public Fields {
public:
    explicit KnownKeys(const JsonNode& node) : node_(node) {}
    const std::vector<std::string_view>& names() const { return names_; }

    using Fields::choice;
    using Fields::color;
    using Fields::number;
    using Fields::section;
    using Fields::vector;
    void any_flag(std::string_view name, std::optional<bool>&, const About&) override { know(name); }
    void number(std::string_view name, std::optional<double>&, const NumberRange&, const About&) override
    {
        know(name);
    }
    void any_whole(std::string_view name, std::optional<int64_t>&, int64_t, int64_t, const About&) override
    {
        know(name);
    }
    void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                const About&) override
    {
        know(name);
        for (const std::string_view each : names)
            if (node_[name].is(each)) value = each;
    }
    void text(std::string_view name, std::string&, const About&) override { know(name); }
    void path(std::string_view name, std::filesystem::path&, const About&) override { know(name); }
    void color(std::string_view name, std::optional<glm::dvec4>&, bool, const About&) override { know(name); }
    void vector(std::string_view name, std::optional<glm::dvec3>&, const NumberRange&, const About&) override
    {
        know(name);
    }
    void numbers(std::string_view name, std::optional<glm::dvec2>&, const NumberRange&, const About&) override
    {
        know(name);
    }
    void wholes(std::string_view name, std::vector<int64_t>&, int64_t, int64_t, const About&) override { know(name); }
    void other(std::string_view name, const std::function<void(const JsonNode&)>&,
               const std::function<std::optional<std::string>()>&, const About&) override
    {
        know(name);
    }
    void section(std::string_view name, const Visit&, const About&) override { know(name); }
    void items(std::string_view name, size_t, size_t, const VisitItem&, const About&) override { know(name); }
    void entries(std::string_view name, std::vector<std::string>, std::string_view, const VisitEntry&,
                 const About&) override
    {
        know(name);
    }
    bool has(std::string_view name, bool) override { return node_[name].exists(); }
    void mention(std::string_view name, const About&) override { know(name); }
    void retired(std::string_view name) override
    {
        if (node_[name].exists()) know(name);  // otherwise error messages would suggest it
    }

private:
    void know(std::string_view name) { names_.push_back(name); }
    JsonNode node_;
    std::vector<std::string_view> names_;
};

class Reader : public Fields {
public:
    /// Refuses unknown keys, then reads the others.
    static void read(const JsonNode& node, const std::filesystem::path& folder, const Visit& visit)
    {
        KnownKeys known(node);
        visit(known);
        node.allow(known.names());
        Reader reader(node, folder);
        visit(reader);
    }

    using Fields::choice;
    using Fields::color;
    using Fields::number;
    using Fields::section;
    using Fields::vector;
    void any_flag(std::string_view name, std::optional<bool>& value, const About& about) override
    {
        if (const Member node = member(name, about)) value = node.flag();
    }
    void number(std::string_view name, std::optional<double>& value, const NumberRange& range,
                const About& about) override
    {
        if (const Member node = member(name, about)) value = node.number(range);
    }
    void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t lower, int64_t upper,
                   const About& about) override
    {
        if (const Member node = member(name, about)) value = node.whole(lower, upper);
    }
    void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                const About& about) override
    {
        if (const Member node = member(name, about)) value = names[node.choice(names)];
    }
    void text(std::string_view name, std::string& value, const About& about) override
    {
        if (const Member node = member(name, about)) value = node.text();
    }
    void path(std::string_view name, std::filesystem::path& value, const About& about) override
    {
        const Member node = member(name, about);
        if (!node) return;
        const std::string text = node.text("a path");
        if (has_controls(text)) node.refuse("a path");
        static_assert(PATH_MAX == 4096);
        if (text.size() >= PATH_MAX) node.refuse("a path of less than 4096 bytes");
        if (is_address(text) && about.allowed == std::string_view(PATH_OR_ADDRESS)) {
            // The query of an address is a credential, and must not appear in the session or in messages.
            value = node.checked([&] {
                const std::string address = take_query(text);
                static_cast<void>(parse_address(address));
                return address;
            });
            return;
        }
        if (is_address(text)) node.refuse(NO_ADDRESS);
        value = std::filesystem::absolute(folder_ / text).lexically_normal();
    }
    void color(std::string_view name, std::optional<glm::dvec4>& value, bool has_alpha, const About& about) override
    {
        const Member node = member(name, about);
        if (!node) return;
        if (has_alpha)
            value = node.parsed(color_of, "a colour, \"#rrggbb\" or \"#rrggbbaa\"");
        else
            value = glm::dvec4(read_color(node), 1.0);
    }
    void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange& range,
                const About& about) override
    {
        if (const Member node = member(name, about)) value = node.vector(range);
    }
    void numbers(std::string_view name, std::optional<glm::dvec2>& value, const NumberRange& range,
                 const About& about) override
    {
        const Member node = member(name, about);
        if (!node) return;
        if (node.count() != 2) node.refuse("two numbers, [from, to]");
        const std::vector<JsonNode> elements = node.elements();
        value = glm::dvec2(elements[0].number(range), elements[1].number(range));
    }
    void wholes(std::string_view name, std::vector<int64_t>& value, int64_t lower, int64_t upper,
                const About& about) override
    {
        const Member node = member(name, about);
        if (!node) return;
        if (node.count() != value.size())
            node.refuse(value.size() == 2 ? "two whole numbers, [width, height]" : "three whole numbers, [x, y, z]");
        const std::vector<JsonNode> elements = node.elements();
        for (size_t i = 0; i < value.size(); ++i) value[i] = elements[i].whole(lower, upper);
    }
    void other(std::string_view name, const std::function<void(const JsonNode&)>& read,
               const std::function<std::optional<std::string>()>&, const About& about) override
    {
        if (const Member node = member(name, about)) read(node);
    }
    void section(std::string_view name, const Visit& visit, const About& about) override
    {
        if (const Member node = member(name, about)) read(node, folder_, visit);
    }
    void items(std::string_view name, size_t, size_t most, const VisitItem& visit, const About& about) override
    {
        const Member node = member(name, about);
        if (!node) return;
        const std::vector<JsonNode> elements = node.elements(0, most);
        for (size_t i = 0; i < elements.size(); ++i)
            read(elements[i], folder_, [&](Fields& f) { visit(f, i, elements.size()); });
    }
    void entries(std::string_view name, std::vector<std::string>, std::string_view, const VisitEntry& visit,
                 const About& about) override
    {
        const Member node = member(name, about);
        if (!node) return;
        for (const std::string& key : node.names()) read(node[key], folder_, [&](Fields& f) { visit(f, key); });
    }
    bool has(std::string_view name, bool) override { return node_[name].exists(); }
    void mention(std::string_view, const About&) override {}
    void check(std::string_view name, bool holds, const std::string& expected) override
    {
        if (holds) return;
        JsonNode node = node_;
        while (!name.empty()) {
            const size_t end = std::min(name.find('.'), name.size());
            node = node[name.substr(0, end)];
            name.remove_prefix(std::min(end + 1, name.size()));
        }
        node.refuse(expected);
    }
    void checked(const std::function<void()>& run) override { node_.checked(run); }

private:
    Reader(const JsonNode& node, const std::filesystem::path& folder) : node_(node), folder_(folder) {}

    /// The value of a key that may be missing. A missing required value counts as present, so that reading it fails.
    struct Member : JsonNode {
        bool is_taken;
        explicit operator bool() const { return is_taken; }
    };
    Member member(std::string_view name, const About& about) const
    {
        const JsonNode node = node_[name];
        return {node, node.exists() || about.is_required};
    }

    JsonNode node_;
    const std::filesystem::path& folder_;
};

}  // namespace

glm::dvec3 read_color(const JsonNode& node)
{
    const auto parse = [](std::string_view text) { return text.size() == 7 ? color_of(text) : std::nullopt; };
    return glm::dvec3(node.parsed(parse, "a colour, \"#rrggbb\""));
}

void read_fields(const JsonNode& node, const std::filesystem::path& folder, const Fields::Visit& visit)
{
    Reader::read(node, folder, visit);
}

CameraSpec read_camera(const JsonNode& node)
{
    CameraSpec camera;
    Reader::read(node, {}, [&](Fields& f) { fields(f, camera); });
    return camera;
}

JsonDocument session_document(std::string_view text, const std::string& origin)
{
    return {text, origin, {.depth = 16, .expected = "a session"}};
}

Session read_session(const JsonDocument& document, const std::filesystem::path& folder)
{
    Session session;
    Reader::read(document.root(), folder, [&](Fields& f) { fields(f, session); });
    return session;
}

std::vector<std::string> removed_keys_in(const JsonDocument& document, const std::string& origin)
{
    if (!document.root()["render"]["adaptive_tolerance"].exists()) return {};
    return {sentence(origin,
                     ": render.adaptive_tolerance is ignored, as the option was removed and every pixel has a ray of "
                     "its own; leave it out")};
}

Session read_lasting(const JsonDocument& document)
{
    Session session;
    Reader::read(document.root(), {}, [&](Fields& f) { lasting_fields(f, session); });
    return session;
}

Session read_settings(const JsonDocument& document)
{
    Session session;
    Reader::read(document.root(), {}, [&](Fields& f) { setting_fields(f, session); });
    return session;
}

Session read_kept(const JsonDocument& document)
{
    Session session;
    Reader::read(document.root(), {}, [&](Fields& f) { kept_fields(f, session); });
    return session;
}

Session parse_session(const std::string& text, const std::filesystem::path& folder, const std::string& origin,
                      const std::vector<std::string>& settings)
{
    JsonDocument document = session_document(text, origin);
    apply_settings(document, settings);
    return read_session(document, folder);
}

}  // namespace shvr
