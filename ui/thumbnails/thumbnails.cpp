#include "ui/thumbnails/thumbnails.h"

#include <cstring>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/image_file.h"
#include "engine/workbench/models/project_picture.h"
#include "ui/files/asked.h"

namespace shvr::ui {

namespace {

using Pictures = std::map<std::filesystem::path, Image8>;

struct State {
    std::filesystem::path folder;
    std::vector<std::filesystem::path> wanted;
    Asked<Pictures> reading;
    int wanted_in_frame = -2;  ///< last frame that wanted pictures
    Pictures pictures;
    std::map<std::filesystem::path, int> places;  ///< rectangles of the atlas
    bool is_stale = false;
};
State state;

/// Reads those that are there and have the right size.
Pictures read(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& paths)
{
    Pictures found;
    for (const std::filesystem::path& path : paths) {
        std::error_code ignored;
        const std::filesystem::path file = project_picture_file(folder, path);
        if (!std::filesystem::is_regular_file(file, ignored)) continue;
        try {
            Image8 picture = read_png(file);
            if (picture.width == PROJECT_PICTURE_WIDTH && picture.height == PROJECT_PICTURE_HEIGHT)
                found.emplace(path, std::move(picture));
        } catch (const Error&) {  // damaged: the next save writes it again
        }
    }
    return found;
}

}  // namespace

void set_thumbnail_folder(const std::filesystem::path& folder)
{
    state.folder = folder;
}

void want_thumbnails(std::span<const std::filesystem::path> paths, bool again)
{
    state.wanted_in_frame = ImGui::GetFrameCount();
    const std::vector<std::filesystem::path> wanted(paths.begin(), paths.end());
    if (!state.folder.empty() && (again || wanted != state.wanted)) {
        state.wanted = wanted;
        state.reading = Asked<Pictures>([folder = state.folder, wanted] { return read(folder, wanted); });
    }
    std::optional<Pictures> found = state.reading.take();
    if (!found || *found == state.pictures) return;
    state.pictures = std::move(*found);
    state.is_stale = true;
}

bool thumbnails_are_stale()
{
    return state.is_stale;
}

bool thumbnails_are_read()
{
    return state.reading.is_pending() && state.wanted_in_frame + 1 >= ImGui::GetFrameCount();
}

void build_with_thumbnails(ImFontAtlas& atlas)
{
    state.is_stale = false;
    state.places.clear();
    for (const auto& [path, picture] : state.pictures)
        state.places[path] = atlas.AddCustomRectRegular(picture.width, picture.height);
    uint8_t* pixels = nullptr;
    int width = 0, height = 0;
    atlas.GetTexDataAsRGBA32(&pixels, &width, &height);
    for (const auto& [path, index] : state.places) {
        const Image8& picture = state.pictures.at(path);
        const ImFontAtlasCustomRect& place = *atlas.GetCustomRectByIndex(index);
        for (int y = 0; y < picture.height; ++y)
            std::memcpy(pixels + 4 * (size_t(place.Y + y) * size_t(width) + place.X),
                        picture.rgba.data() + 4 * size_t(y) * size_t(picture.width), 4 * size_t(picture.width));
    }
}

bool draw_thumbnail(const std::filesystem::path& path, const ImVec2& begin, const ImVec2& end)
{
    const auto place = state.places.find(path);
    if (place == state.places.end()) return false;
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    ImVec2 from, to;
    atlas.CalcCustomRectUV(atlas.GetCustomRectByIndex(place->second), &from, &to);
    ImGui::GetWindowDrawList()->AddImage(atlas.TexID, begin, end, from, to);
    return true;
}

}  // namespace shvr::ui
