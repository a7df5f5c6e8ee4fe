// The table of keys, for README.md and for --set, which looks up there which values are texts.

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/look/session_color.h"
#include "engine/session/session_keys.h"

namespace shvr {
namespace {

std::string in_code(std::string_view text)
{
    return sentence("`\"", text, "\"`");
}

std::string range_text(double lower, double upper)
{
    // Prints fractions without an exponent: 0.0001, not the shorter 1e-04.
    const auto digits = [](double value) { return value == std::floor(value) ? digits_of(value) : sentence(value); };
    return digits(lower) + " ... " + digits(upper);
}

/// Visits a new session. `takes_optional_forms` selects between two forms whose keys exclude each other.
class Table : public Fields {
public:
    Table(std::vector<SessionKey>& rows, std::string prefix, bool takes_optional_forms)
        : rows_(rows), prefix_(std::move(prefix)), takes_optional_forms_(takes_optional_forms)
    {}

    using Fields::choice;
    using Fields::color;
    using Fields::number;
    using Fields::section;
    using Fields::vector;
    void any_flag(std::string_view name, std::optional<bool>& value, const About& about) override
    {
        add(name, about, "true, false", value ? (*value ? "true" : "false") : "");
    }
    void number(std::string_view name, std::optional<double>& value, const NumberRange& range,
                const About& about) override
    {
        add(name, about, range_text(range.lower, range.upper), value ? digits_of(*value) : "");
    }
    void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t lower, int64_t upper,
                   const About& about) override
    {
        add(name, about, sentence(lower, " ... ", upper), value ? sentence(*value) : "");
    }
    void choice(std::string_view name, std::string& value, const std::vector<std::string_view>& names,
                const About& about) override
    {
        std::string list;
        for (const std::string_view each : names) list += (list.empty() ? "" : ", ") + in_code(each);
        add(name, about, list, in_code(value), true);
    }
    void text(std::string_view name, std::string& value, const About& about) override
    {
        add(name, about, "text", value.empty() ? "" : in_code(value), true);
    }
    void path(std::string_view name, std::filesystem::path&, const About& about) override
    {
        add(name, about, "path", "", true);
    }
    void color(std::string_view name, std::optional<glm::dvec4>& value, bool has_alpha, const About& about) override
    {
        const char* const allowed = has_alpha ? "`\"#rrggbb\"` or `\"#rrggbbaa\"`" : "`\"#rrggbb\"`";
        add(name, about, allowed, value ? in_code(text_of_color(*value)) : "", true);
    }
    void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange& range,
                const About& about) override
    {
        const auto list = [](const glm::dvec3& v) {
            return "`[" + digits_of(v.x) + ", " + digits_of(v.y) + ", " + digits_of(v.z) + "]`";
        };
        add(name, about, range_text(range.lower, range.upper), value ? list(*value) : "");
    }
    void numbers(std::string_view name, std::optional<glm::dvec2>&, const NumberRange& range,
                 const About& about) override
    {
        add(name, about, range_text(range.lower, range.upper), "");
    }
    void wholes(std::string_view name, std::vector<int64_t>& value, int64_t lower, int64_t upper,
                const About& about) override
    {
        std::string list;
        for (const int64_t each : value) list += sentence(list.empty() ? "`[" : ", ", each);
        add(name, about, sentence(lower, " ... ", upper), list + "]`");
    }
    void other(std::string_view name, const std::function<void(const JsonNode&)>&,
               const std::function<std::optional<std::string>()>&, const About& about) override
    {
        add(name, about, "", "");
    }
    void section(std::string_view name, const Visit& visit, const About& about) override
    {
        add(name, about, "", "");
        visit_below(name, visit);
    }
    void items(std::string_view name, size_t, size_t, const VisitItem& visit, const About& about) override
    {
        add(name, about, "", "");
        visit_below(sentence(name, ".N"), [&](Fields& f) { visit(f, 0, 1); });
    }
    void entries(std::string_view name, std::vector<std::string>, std::string_view placeholder, const VisitEntry& visit,
                 const About& about) override
    {
        const std::string entry = sentence(name, ".", placeholder);
        add(entry, about, "", "");
        visit_below(entry, [&](Fields& f) { visit(f, std::string(placeholder)); });
    }
    bool has(std::string_view, bool) override { return takes_optional_forms_; }
    void mention(std::string_view name, const About& about) override { add(name, about, "", ""); }

private:
    void add(std::string_view name, const About& about, const std::string& range, const std::string& value,
             bool is_text = false)
    {
        SessionKey row{.name = prefix_ + std::string(name), .meaning = about.meaning, .is_text = is_text};
        const bool is_known = std::ranges::find(rows_, row.name, &SessionKey::name) != rows_.end();
        if (row.meaning.empty() || is_known) return;
        const std::string unit = about.unit;
        row.allowed = about.allowed[0] ? about.allowed : unit + (unit.empty() || range.empty() ? "" : ", ") + range;
        row.standard = about.standard[0] ? about.standard : about.is_required ? "required" : value;
        rows_.push_back(std::move(row));
    }
    void visit_below(std::string_view name, const Visit& visit)
    {
        Table table(rows_, prefix_ + std::string(name) + ".", takes_optional_forms_);
        visit(table);
    }

    std::vector<SessionKey>& rows_;
    std::string prefix_;
    bool takes_optional_forms_;
};

}  // namespace

std::vector<SessionKey> session_keys()
{
    std::vector<SessionKey> rows;
    for (const bool takes_optional_forms : {true, false}) {
        Session session;
        Table table(rows, "", takes_optional_forms);
        fields(table, session);
    }
    Camera orthographic{.projection = Camera::Projection::orthographic};
    Table table(rows, "cameras.NAME.", false);
    fields(table, orthographic);
    return rows;
}

std::vector<SessionKey> keys_of(const Fields::Visit& visit)
{
    std::vector<SessionKey> rows;
    for (const bool takes_optional_forms : {true, false}) {
        Table table(rows, "", takes_optional_forms);
        visit(table);
    }
    return rows;
}

bool SessionKey::covers(std::string_view key) const
{
    std::string_view pattern = name;
    while (!pattern.empty() && !key.empty()) {
        const size_t end = std::min(pattern.find('.'), pattern.size()), key_end = std::min(key.find('.'), key.size());
        const std::string_view part = pattern.substr(0, end);
        if (part != "N" && part != "NAME" && part != key.substr(0, key_end)) return false;
        pattern.remove_prefix(std::min(end + 1, pattern.size()));
        key.remove_prefix(std::min(key_end + 1, key.size()));
    }
    return pattern.empty() && key.empty();
}

}  // namespace shvr
