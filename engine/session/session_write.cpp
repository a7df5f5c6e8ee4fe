// Writes session files. Keys have the order in which session_keys*.cpp visits them.

#include <nlohmann/json.hpp>

#include "engine/look/session_color.h"
#include "engine/remote/address.h"
#include "engine/session/kept_settings.h"
#include "engine/session/lasting_settings.h"
#include "engine/session/session_keys.h"

namespace shvr {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string path_text(const std::filesystem::path& path, const std::filesystem::path& folder)
{
    if (leads_to_network(path)) return url_without_query(path.string());  // a query is a credential
    const std::filesystem::path whole = std::filesystem::absolute(folder / ".").lexically_normal();
    const std::filesystem::path relative = path.lexically_relative(whole);
    // The files of a project move together: they are in its folder shvr, or in the folder that contains shvr.
    const bool is_project = whole.parent_path().filename() == "shvr";
    auto step = relative.begin();
    if (is_project && step != relative.end() && *step == "..") ++step;
    const bool is_inside = !relative.empty() && (step == relative.end() || *step != "..");
    return (is_inside ? relative : path).generic_string();
}

class Writer : public Fields {
public:
    static OrderedJson write(const std::filesystem::path& folder, const Visit& visit)
    {
        Writer writer(folder);
        visit(writer);
        return std::move(writer.object_);
    }

    using Fields::choice;
    using Fields::color;
    using Fields::number;
    using Fields::section;
    using Fields::vector;
    void any_flag(std::string_view name, std::optional<bool>& value, const About&) override
    {
        if (value) put(name, *value);
    }
    void number(std::string_view name, std::optional<double>& value, const NumberRange&, const About&) override
    {
        if (value) put(name, *value);
    }
    void any_whole(std::string_view name, std::optional<int64_t>& value, int64_t, int64_t, const About&) override
    {
        if (value) put(name, *value);
    }
    void choice(std::string_view name, std::string& value, const std::vector<std::string_view>&, const About&) override
    {
        put(name, value);
    }
    void text(std::string_view name, std::string& value, const About&) override
    {
        if (!value.empty()) put(name, value);
    }
    void path(std::string_view name, std::filesystem::path& value, const About& about) override
    {
        if (!value.empty() || about.is_required) put(name, path_text(value, folder_));
    }
    void color(std::string_view name, std::optional<glm::dvec4>& value, bool, const About&) override
    {
        if (value) put(name, text_of_color(*value));
    }
    void vector(std::string_view name, std::optional<glm::dvec3>& value, const NumberRange&, const About&) override
    {
        if (value) put(name, {value->x, value->y, value->z});
    }
    void numbers(std::string_view name, std::optional<glm::dvec2>& value, const NumberRange&, const About&) override
    {
        if (value) put(name, {value->x, value->y});
    }
    void wholes(std::string_view name, std::vector<int64_t>& value, int64_t, int64_t, const About&) override
    {
        put(name, value);
    }
    void other(std::string_view name, const std::function<void(const JsonNode&)>&,
               const std::function<std::optional<std::string>()>& written, const About&) override
    {
        if (const std::optional<std::string> text = written()) put(name, OrderedJson::parse(*text));
    }
    void section(std::string_view name, const Visit& visit, const About&) override { put(name, write(folder_, visit)); }
    void items(std::string_view name, size_t count, size_t, const VisitItem& visit, const About&) override
    {
        OrderedJson array = OrderedJson::array();
        for (size_t i = 0; i < count; ++i) array.push_back(write(folder_, [&](Fields& f) { visit(f, i, count); }));
        put(name, std::move(array));
    }
    void entries(std::string_view name, std::vector<std::string> keys, std::string_view, const VisitEntry& visit,
                 const About&) override
    {
        // Appends to a list, since inserting by key is a linear search, and there may be 100,000 cameras.
        OrderedJson::object_t members;
        for (const std::string& key : keys)
            members.emplace_back(key, write(folder_, [&](Fields& f) { visit(f, key); }));
        put(name, OrderedJson(std::move(members)));
    }
    bool has(std::string_view, bool is_set) override { return is_set; }
    void mention(std::string_view, const About&) override {}

private:
    explicit Writer(const std::filesystem::path& folder) : folder_(folder) {}
    void put(std::string_view name, OrderedJson value) { object_[std::string(name)] = std::move(value); }

    OrderedJson object_ = OrderedJson::object();
    const std::filesystem::path& folder_;
};

bool is_row(const OrderedJson& value)
{
    return std::ranges::none_of(value, [](const OrderedJson& member) { return member.is_structured(); });
}

/// Returns JSON text, indented by two spaces. Arrays of plain values, and control points, take one line each.
std::string laid_out(const OrderedJson& value, const std::string& indent, bool may_be_row)
{
    if (!value.is_structured() || value.empty() || (is_row(value) && (value.is_array() || may_be_row)))
        return value.dump();
    const std::string inner = indent + "  ";
    std::string text;
    for (const auto& item : value.items()) {
        text += (text.empty() ? "\n" : ",\n") + inner;
        if (value.is_object()) text += OrderedJson(item.key()).dump() + ": ";
        text += laid_out(item.value(), inner, value.is_array());
    }
    text += "\n" + indent;
    return value.is_array() ? "[" + text + "]" : "{" + text + "}";
}

SettingValues sections_of(const OrderedJson& object)
{
    SettingValues values;
    for (const auto& section : object.items()) values[section.key()] = section.value().dump();
    return values;
}

}  // namespace

std::string write_fields(const std::filesystem::path& folder, const Fields::Visit& visit)
{
    try {
        return Writer::write(folder, visit).dump();
    } catch (const OrderedJson::type_error&) {
        fail("a name or path is not valid UTF-8, so JSON cannot hold it; expected UTF-8");
    }
}

SettingValues lasting_settings(const Session& session)
{
    Session written = session;  // a copy, since fields() takes a mutable session
    return sections_of(Writer::write({}, [&](Fields& f) { lasting_fields(f, written); }));
}

SettingValues kept_settings(const Session& session)
{
    // A copy, as above, but without surfaces: there may be many of them, and this function is called often.
    Session written;
    take_kept_sections(written, session);
    return sections_of(Writer::write({}, [&](Fields& f) { kept_fields(f, written); }));
}

std::string to_text(const Session& session, const std::filesystem::path& folder)
{
    Session written = session;  // a copy, since fields() takes a mutable session
    for (MeshLook& mesh : written.meshes)
        if (std::filesystem::absolute(folder / ".").lexically_normal() != session_folder(session) / "")
            mesh.file = path_text(mesh_path(session, mesh), folder);
    try {
        const OrderedJson document = Writer::write(folder, [&](Fields& f) { fields(f, written); });
        return laid_out(document, "", false) + "\n";
    } catch (const OrderedJson::type_error&) {
        fail("session of ", session.volume_path.string(),
             ": a name or path is not valid UTF-8, so JSON cannot hold it; ", "expected UTF-8");
    }
}

std::string mesh_file_name(const Session& session, const std::filesystem::path& path)
{
    return path_text(std::filesystem::absolute(path).lexically_normal(), session_folder(session));
}

}  // namespace shvr
