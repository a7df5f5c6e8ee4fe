#pragma once
// A workbench and a folder with a scan, "scan.nrrd" of 24 x 20 x 16 voxels, for tests of files.

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/gpu.h"
#include "tests/support/volume_files.h"
#include "tests/support/workbench_state.h"

namespace shvr::test {

/// Images of the texts: a solid block per text, half as wide per letter as it is high.
inline std::vector<ui::TextImage> blocks(std::span<const std::string> texts, double pixels)
{
    std::vector<ui::TextImage> images;
    for (const std::string& text : texts) {
        ui::TextImage image{.pixels = {int(0.5 * pixels * double(text.size())), int(pixels)}, .coverage{}};
        image.coverage.assign(size_t(image.pixels.x) * size_t(image.pixels.y), 255);
        images.push_back(std::move(image));
    }
    return images;
}

struct FilesDesk {
    TemporaryFolder folder;
    ui::Workbench bench;

    explicit FilesDesk(Renderer& renderer, const glm::uvec2& pixels = {48, 40})
        : bench(renderer, {.has_servo = false, .draw_texts = blocks})
    {
        bench.set_pixels(pixels);
        std::string scan = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 20 16\nencoding: raw\n\n";
        for (int voxel = 0; voxel < 24 * 20 * 16; ++voxel) scan += char(voxel * 11 % 251);
        folder.write("scan.nrrd", scan);
    }
    std::string path(const char* name) const { return (folder.path / name).string(); }
    bool said(const std::string& text) const
    {
        for (const ui::Message& message : bench.messages().all())
            if (message.text.find(text) != std::string::npos) return true;
        return false;
    }
    void open(const char* name)
    {
        bench.perform(ui::Open{path(name)});
        settle(bench);
    }
};

}  // namespace shvr::test
