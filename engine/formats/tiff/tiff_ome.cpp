// Reads OME-XML (https://docs.openmicroscopy.org/ome-model/). Its Pixels element states the size of the stack, the
// spacing of voxels and the order of planes; its TiffData elements map planes to pages.

#include <tiffio.h>

#include <cmath>
#include <map>
#include <pugixml.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/header_fields.h"
#include "engine/formats/tiff/tiff_description.h"

namespace shvr {
namespace {

/// Maximum size of the XML; the parser takes several times as much memory.
constexpr size_t MAX_XML_BYTES = size_t{16} << 20;

/// Returns a node's name without its namespace: "OME:Image" -> "Image".
std::string_view name_of(const pugi::xml_node& node)
{
    const std::string_view name = node.name();
    return name.substr(name.find(':') + 1);
}

template <class Take>
void for_each_child(const pugi::xml_node& node, std::string_view name, const Take& take)
{
    for (const pugi::xml_node& child : node.children()) {
        if (name_of(child) == name) take(child);
    }
}

pugi::xml_node first_child(const pugi::xml_node& node, std::string_view name)
{
    for (const pugi::xml_node& child : node.children()) {
        if (name_of(child) == name) return child;
    }
    return {};
}

class OmeReader {
public:
    OmeReader(const TiffFile& file, int samples, TiffRole role)
        : path_(file.path()), subject_(path_.string() + ": its OME-XML"), samples_(samples), role_(role)
    {}

    TiffDescription read(std::string_view text)
    {
        if (text.size() > MAX_XML_BYTES)
            fail(subject_, " has ", text.size(), " bytes; expected at most ", MAX_XML_BYTES);
        pugi::xml_document document;
        const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
        const pugi::xml_node root = first_child(document, "OME");
        if (!result || !root) {
            fail(subject_, " cannot be read: ", result ? "it has no element OME" : result.description(),
                 "; expected a complete XML document");
        }
        if (!is_companion_) own_uuid_ = root.attribute("UUID").value();
        if (const pugi::xml_node elsewhere = first_child(root, "BinaryOnly")) return read_companion(elsewhere);
        const pugi::xml_node pixels = largest_pixels(root);
        read_sizes(pixels);
        read_planes(pixels);
        constexpr const char* SPACING[] = {"PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"};
        constexpr const char* UNIT[] = {"PhysicalSizeXUnit", "PhysicalSizeYUnit", "PhysicalSizeZUnit"};
        for (int axis = 0; axis < 3; ++axis) {
            const std::optional<double> spacing = number_of(pixels.attribute(SPACING[axis]).value());
            if (!spacing || !std::isfinite(*spacing) || *spacing <= 0.0) continue;
            result_.spacing[axis] = *spacing;
            result_.unit[axis] = pixels.attribute(UNIT[axis]).as_string("um");
        }
        for_each_child(pixels, "Channel", [&](const pugi::xml_node& channel) {
            const int64_t colors = whole_of(channel.attribute("SamplesPerPixel").value()).value_or(1);
            if (colors == 1 && result_.channel_names.size() < size_t(result_.channels)) {
                result_.channel_names.emplace_back(channel.attribute("Name").value());
            }
        });
        return std::move(result_);
    }

private:
    /// Reads the XML of the whole stack from another file in the same folder: "x.companion.ome", or a TIFF.
    TiffDescription read_companion(const pugi::xml_node& elsewhere)
    {
        const std::string stated = elsewhere.attribute("MetadataFile").value();
        if (is_companion_ || stated.empty() || has_controls(stated))
            fail(subject_, " is in another file, ", in_quotes(stated), "; expected the XML with the images",
                 is_companion_ ? " there" : ", or the name of its file");
        const std::filesystem::path companion = file_stated(path_, stated);
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(companion, ignored))
            fail(subject_, " is in another file, ", in_quotes(stated),
                 ", which is missing; expected it next to this one");
        std::string text = read_head(companion, MAX_XML_BYTES + 1);
        if (TiffFile::begins(text)) {
            const TiffFile tiff(companion);
            text = TiffPage(tiff, read_directories(tiff).pages.front().offset, 1).text(TIFFTAG_IMAGEDESCRIPTION);
        }
        subject_ = companion.string() + ": its OME-XML";
        is_companion_ = true;
        return read(text);
    }

    int64_t side(const pugi::xml_node& pixels, const char* name) const
    {
        const char* const stated = pixels.attribute(name).value();
        const std::optional<int64_t> side = whole_of(stated);
        if (!side || *side < 1 || *side > int64_t(MAX_TIFF_PAGES)) {
            fail(subject_, ": ", name, " is ", in_quotes(stated), "; expected a whole number from 1 to ",
                 MAX_TIFF_PAGES);
        }
        return *side;
    }

    pugi::xml_node largest_pixels(const pugi::xml_node& root)
    {
        pugi::xml_node largest;
        std::string name;
        double max_voxels = 0.0;
        int count = 0;
        for_each_child(root, "Image", [&](const pugi::xml_node& image) {
            const pugi::xml_node pixels = first_child(image, "Pixels");
            if (!pixels) return;
            ++count;
            double voxels = 1.0;
            for (const char* axis : {"SizeX", "SizeY", "SizeZ"}) {
                voxels *= double(side(pixels, axis));
            }
            if (voxels <= max_voxels) return;
            max_voxels = voxels;
            largest = pixels;
            name = image.attribute("Name").value();
        });
        if (count == 0) fail(subject_, " has no Image with Pixels; expected at least one");
        if (count > 1) {
            result_.warnings.push_back(sentence("the file holds ", count, " images; the largest",
                                                name.empty() ? "" : ", " + in_quotes(name) + ",", " was taken"));
        }
        return largest;
    }

    void read_sizes(const pugi::xml_node& pixels)
    {
        result_.writer = TiffDescription::Writer::ome;
        result_.slices = side(pixels, "SizeZ");
        result_.frames = side(pixels, "SizeT");
        result_.channels = side(pixels, "SizeC");
        // SizeC also counts the samples of a pixel, which share a page; `channels` counts only channels with own pages.
        if (result_.channels % samples_ != 0) {
            fail(subject_, ": SizeC is ", result_.channels, "; expected a multiple of the ", samples_,
                 " samples of a pixel");
        }
        result_.channels /= samples_;
        const int64_t planes = result_.slices * result_.channels;
        if (planes > int64_t(MAX_TIFF_PAGES) || planes * result_.frames > int64_t(MAX_TIFF_PAGES)) {
            fail(subject_, " counts ", result_.slices, " x ", result_.channels, " x ", result_.frames,
                 " slices, channels and time points; expected at most ", MAX_TIFF_PAGES, " pages");
        }
        result_.pages.assign(size_t(planes * result_.frames), TiffDescription::NO_PAGE);

        const std::string order = pixels.attribute("DimensionOrder").value();
        for (const char* known : {"XYZCT", "XYZTC", "XYCTZ", "XYCZT", "XYTCZ", "XYTZC"}) {
            if (order == known) order_ = order.substr(2);
        }
        if (order_.empty()) {
            fail(subject_, ": DimensionOrder is ", in_quotes(order), "; expected XYZCT, XYZTC, XYCTZ, XYCZT, XYTCZ or ",
                 "XYTZC");
        }
    }

    int64_t size(char axis) const
    {
        return axis == 'Z' ? result_.slices : axis == 'C' ? result_.channels : result_.frames;
    }

    /// Returns the index in `pages` of plane number `plane`, counted in the order that DimensionOrder states.
    size_t place_of(int64_t plane) const
    {
        int64_t at[3] = {};  // Z, C, T
        for (const char axis : order_) {
            at[axis == 'Z' ? 0 : axis == 'C' ? 1 : 2] = plane % size(axis);
            plane /= size(axis);
        }
        return size_t(at[0] + result_.slices * (at[1] + result_.channels * at[2]));
    }

    int64_t whole(const pugi::xml_node& node, const char* name, int64_t fallback) const
    {
        const pugi::xml_attribute attribute = node.attribute(name);
        if (!attribute) return fallback;
        const std::optional<int64_t> number = whole_of(attribute.value());
        if (!number || *number < 0 || *number > int64_t(MAX_TIFF_PAGES)) {
            fail(subject_, ": ", name, " is ", in_quotes(attribute.value()), "; expected a whole number from 0 to ",
                 MAX_TIFF_PAGES);
        }
        return *number;
    }

    int64_t first_plane(const pugi::xml_node& data) const
    {
        int64_t plane = 0;
        int64_t step = 1;
        for (const char axis : order_) {
            const char* const name = axis == 'Z' ? "FirstZ" : axis == 'C' ? "FirstC" : "FirstT";
            int64_t first = whole(data, name, 0);
            if (axis == 'C') first /= samples_;
            if (first >= size(axis)) {
                fail(subject_, ": ", name, " is ", first, "; expected less than the ", size(axis), " there are");
            }
            plane += first * step;
            step *= size(axis);
        }
        return plane;
    }

    void read_planes(const pugi::xml_node& pixels)
    {
        const auto planes = int64_t(result_.pages.size());
        std::map<std::string, uint32_t> files;  // file numbers by their names in the XML; 0: this file
        std::vector<uint32_t> file_of_page;     // empty until a file is named
        int64_t stated = 0;
        bool is_stated = false;
        for_each_child(pixels, "TiffData", [&](const pugi::xml_node& data) {
            is_stated = true;
            uint32_t number = 0;
            if (const pugi::xml_node file = first_child(data, "UUID"); file.attribute("FileName")) {
                const std::string name = file.attribute("FileName").value();
                const bool is_this = name == path_.filename().string() ||
                                     (!own_uuid_.empty() && own_uuid_ == trimmed(file.child_value()));
                const auto next = uint32_t(files.size() + 1);
                number = files.try_emplace(name, is_this ? 0 : next).first->second;
                if (files.size() > MAX_FILES)
                    fail(subject_, " names more than ", MAX_FILES, " files; expected at most that many");
            }
            const int64_t page = whole(data, "IFD", 0);
            const int64_t first = first_plane(data);
            const int64_t count = whole(data, "PlaneCount", data.attribute("IFD") ? 1 : planes - first);
            stated += count;
            if (stated > 2 * int64_t(MAX_TIFF_PAGES)) {
                fail(subject_, " places ", stated, " planes; expected the ", planes, " there are");
            }
            if (!files.empty()) file_of_page.resize(result_.pages.size());
            for (int64_t i = 0; i < std::min(count, planes - first); ++i) {
                result_.pages[place_of(first + i)] = uint32_t(page + i);
                if (!files.empty()) file_of_page[place_of(first + i)] = number;
            }
        });
        name_files(files, std::move(file_of_page));
        for (int64_t i = 0; i < planes && !is_stated; ++i) result_.pages[place_of(i)] = uint32_t(i);
    }

    /// Sets the files of a stack in several files. If only one file is named, it is this file, perhaps renamed since.
    void name_files(const std::map<std::string, uint32_t>& files, std::vector<uint32_t> file_of_page)
    {
        if (files.size() < 2 || role_ != TiffRole::whole) return;
        result_.files.assign(files.size() + 1, path_);
        for (const auto& [name, number] : files) {
            if (number == 0) continue;
            if (has_controls(name)) fail(subject_, " names a file ", in_quotes(name), "; expected the name of a file");
            result_.files[number] = file_stated(path_, name);
            std::error_code ignored;
            if (!std::filesystem::is_regular_file(result_.files[number], ignored))
                fail(subject_, " describes a stack in several files; ", in_quotes(name),
                     " is missing; expected it next to this one");
        }
        result_.file_of_page = std::move(file_of_page);
    }

    static constexpr size_t MAX_FILES = 65536;

    std::filesystem::path path_;
    std::string subject_;
    std::string own_uuid_{};     ///< the UUID of this file
    bool is_companion_ = false;  ///< whether the XML being read is in another file
    int samples_;
    TiffRole role_;
    std::string order_;
    TiffDescription result_;
};

}  // namespace

TiffDescription read_ome_description(const TiffFile& file, std::string_view text, int samples, TiffRole role)
{
    return OmeReader(file, samples, role).read(text);
}

}  // namespace shvr
