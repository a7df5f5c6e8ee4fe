#pragma once
// Shared by the XML formats.

#include <string>
#include <string_view>

#include <pugixml.hpp>

namespace shvr {

struct StringWriter : pugi::xml_writer {
    std::string text;
    void write(const void* data, size_t size) override { text.append(static_cast<const char*>(data), size); }
};

/// The name without its namespace.
inline std::string_view name_of(const pugi::xml_node& node)
{
    const std::string_view name = node.name();
    return name.substr(name.find(':') + 1);
}

}  // namespace shvr
