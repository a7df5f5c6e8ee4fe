// What is drawn over a figure, in its file.

#include "engine/workbench/actions/figure_text.h"

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

void write_picture(const std::filesystem::path& path, const PictureTexts& texts)
{
    const ImageF rows{2, 1, std::vector<float>(8, 1.0f)};
    const std::unique_ptr<ImageWriter> writer = image_writer(path, rows.width, rows.height, texts);
    writer->add(rows);
    writer->commit();
}

}  // namespace

TEST_CASE("what is drawn over a figure comes back from its file, PNG or TIFF")
{
    const TemporaryFolder folder;
    const DrawnElements drawn{.has_scale_bar = true,
                              .has_legend = true,
                              .title = "Bellis\nperennis \u00b5",
                              .texts = {{{1.5, 2.0, 1e6}, "\"stem\""}, {{0.1, 0.2, 0.3}, "pith"}},
                              .text_pixels = 12.5};
    for (const char* name : {"a.png", "a.tif"}) {
        CAPTURE(name);
        PictureTexts texts{{"SHVR session", "{}"}};
        add_elements(texts, drawn);
        write_picture(folder.path / name, texts);
        const std::optional<DrawnElements> read = elements_in_picture(folder.path / name);
        REQUIRE(read);
        CHECK((read->has_scale_bar && read->has_legend));
        CHECK_FALSE((read->has_color_bar || read->has_axes || read->has_measurements));
        CHECK(read->title == drawn.title);
        REQUIRE(read->texts.size() == 2);
        CHECK(read->texts[0].voxel == drawn.texts[0].voxel);
        CHECK(read->texts[0].text == "\"stem\"");
        CHECK(read->text_pixels == 12.5);
    }
    PictureTexts none;
    add_elements(none, {.text_pixels = 20.0});
    CHECK(none.empty());
    write_picture(folder.path / "b.png", none);
    CHECK_FALSE(elements_in_picture(folder.path / "b.png"));
    CHECK_FALSE(elements_in_picture(folder.write("c.png", "no picture")));
    CHECK_FALSE(elements_in_picture(folder.path / "missing.png"));
    CHECK_FALSE(elements_in_picture(folder.write("d.json", "{}")));
}

TEST_CASE("what a picture's file states wrongly of its figure is refused, and not written")
{
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path / "a.png";
    const auto says = [&](const std::string& text, const std::string& words) {
        write_picture(path, {{"SHVR figure", text}});
        CHECK_THROWS_WITH_AS(static_cast<void>(elements_in_picture(path)), doctest::Contains(words.c_str()), Error);
    };
    says("{\"shvr_figure\": 2}", "a.png: key shvr_figure is 2; expected");
    says("{\"title\": \"a\"}", "key shvr_figure is missing");
    says("{\"shvr_figure\": 1, \"frame\": true}", "unknown key frame");
    says("{\"shvr_figure\": 1, \"text_pixels\": 5}", "key text_pixels is 5; expected a number from 6 to 1000");
    says("{\"shvr_figure\": 1", "a.png");
    says(std::string(100, '['), "nests deeper than 8");
    says("{\"shvr_figure\": 1, \"title\": \"" + std::string(1 << 16, 'a') + "\"}", "expected at most 65536");
    DrawnElements many;
    many.texts.assign(MAX_FIGURE_TEXTS + 1, {{}, "a"});
    PictureTexts texts;
    CHECK_THROWS_WITH_AS(add_elements(texts, many), doctest::Contains("key texts"), Error);
    CHECK(texts.empty());
}
