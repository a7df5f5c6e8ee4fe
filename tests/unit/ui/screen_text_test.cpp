// The words of a frame, read back from its triangles, by Dear ImGui alone: no window and no device.

#include "ui/screen_text.h"

#include <algorithm>
#include <functional>

#include <doctest/doctest.h>
#include <imgui/imgui.h>

using namespace shvr::ui;

namespace {

std::vector<ScreenText> drawn(const std::function<void()>& draw)
{
    ImGuiContext* const context = ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {400.0f, 300.0f};
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsAlpha8(&pixels, &width, &height);
    std::vector<ScreenText> texts;
    for (int frame = 0; frame < 3; ++frame) {  // windows find their sizes
        ImGui::NewFrame();
        ImGui::SetNextWindowPos({10.0f, 20.0f});
        ImGui::SetNextWindowSize({120.0f, 100.0f});
        ImGui::Begin("here", nullptr, ImGuiWindowFlags_NoDecoration);
        draw();
        ImGui::End();
        ImGui::Render();
        texts = screen_texts(*ImGui::GetDrawData(), *io.Fonts);
    }
    ImGui::DestroyContext(context);
    return texts;
}

}  // namespace

TEST_CASE("words are read with their spaces, window and place, in the order in which they were drawn")
{
    const auto texts = drawn([] {
        ImGui::TextUnformatted("two words");
        ImGui::Button("press");
    });
    REQUIRE(texts.size() == 2);
    CHECK(texts[0].text == "two words");
    CHECK(texts[0].window == "here");
    CHECK_FALSE(texts[0].is_cut);
    CHECK(texts[0].begin.x >= 10.0f);
    CHECK(texts[0].end.x < 130.0f);
    CHECK(texts[0].begin.y > 20.0f);
    CHECK(texts[1].text == "press");
    CHECK(texts[1].begin.y > texts[0].end.y);
}

TEST_CASE("what is cut off at its window's edge is told, and what is out of sight is not read")
{
    const auto texts = drawn([] {
        ImGui::TextUnformatted("longer_than_the_window_is_wide");
        ImGui::Dummy({0.0f, 300.0f});
        ImGui::TextUnformatted("far below");
    });
    REQUIRE(texts.size() == 1);
    CHECK(texts[0].is_cut);
    CHECK(std::string("longer_than_the_window_is_wide").starts_with(texts[0].text));
    CHECK(texts[0].end.x <= 130.0f);
}

TEST_CASE("words that lie side by side on one line stay two, and two lines stay two")
{
    const auto texts = drawn([] {
        ImGui::TextUnformatted("left");
        ImGui::SameLine(70.0f);
        ImGui::TextUnformatted("right");
        ImGui::TextUnformatted("below");
    });
    REQUIRE(texts.size() == 3);
    CHECK(texts[0].text == "left");
    CHECK(texts[1].text == "right");
    CHECK(texts[2].text == "below");
}

TEST_CASE("as JSON")
{
    const std::vector<ScreenText> texts{{"a \"b\"", "here", {1, 2}, {3, 4}, true, false}};
    CHECK(json_of(texts, {.number = 7, .is_sharp = true, .is_kept = false}) ==
          "{\"frame\":7,\"sharp\":true,\"kept\":false,\"texts\":[\n{\"text\":\"a \\\"b\\\"\",\"window\":\"here\","
          "\"box\":[1,2,3,4],\"cut\":true,\"scrolled\":false}]}\n");
}
