#include "engine/workbench/models/messages.h"

#include <sys/resource.h>

#include <algorithm>
#include <new>
#include <string_view>

#include "engine/base/error.h"

namespace shvr::ui {

namespace {

size_t end_of_path(const std::string& text, size_t begin)
{
    size_t end = text.size();
    for (const std::string_view after : {", ", "; ", ": ", " (", " and "}) end = std::min(end, text.find(after, begin));
    return end;
}

}  // namespace

std::string told_of(const std::exception& error)
{
    if (!dynamic_cast<const std::bad_alloc*>(&error)) return error.what();
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return sentence("host memory is exhausted, with ", usage.ru_maxrss / 1024,
                    " MiB in use; expected more: close other programs, or set a smaller budget for Memory in the "
                    "preferences");
}

std::string without_folders(const std::string& text)
{
    std::string cut;
    for (size_t at = 0, end = 0; at < text.size(); at = end) {
        const bool begins_word = at == 0 || text[at - 1] == ' ';
        const bool begins_path = begins_word && text[at] == '/' && at + 1 < text.size() && text[at + 1] != ' ';
        end = begins_path ? end_of_path(text, at) : at + 1;
        const std::string_view part = std::string_view(text).substr(at, end - at);
        const size_t name = part.substr(0, part.size() - 1).rfind('/');  // "/scans/leaf/" is called "leaf/"
        const bool has_folders = begins_path && name != std::string_view::npos && name > 0;
        cut += has_folders ? ".../" : "";
        cut += has_folders ? part.substr(name + 1) : part;
    }
    return cut;
}

}  // namespace shvr::ui
