#include "io/meshes/plain/obj_keywords.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace octopair::io {

ObjKeyword obj_keyword(std::string_view word) {
    using enum ObjKeyword;
    // The frequent ones come first.
    static constexpr std::pair<std::string_view, ObjKeyword> keywords[] = {{"v", vertex},
                                                                           {"f", face},
                                                                           {"vn", ignored},
                                                                           {"vt", ignored},
                                                                           {"s", ignored},
                                                                           {"g", group},
                                                                           {"o", object},
                                                                           {"usemtl", material},
                                                                           {"l", line},
                                                                           {"p", points},
                                                                           {"fo", face},
                                                                           {"mtllib", ignored},
                                                                           {"vp", ignored},
                                                                           {"mg", ignored},
                                                                           {"usemap", ignored},
                                                                           {"maplib", ignored},
                                                                           {"lod", ignored},
                                                                           {"bevel", ignored},
                                                                           {"c_interp", ignored},
                                                                           {"d_interp", ignored},
                                                                           {"ctech", ignored},
                                                                           {"stech", ignored},
                                                                           {"shadow_obj", ignored},
                                                                           {"csh", ignored},
                                                                           {"trace_obj", ignored},
                                                                           {"call", call},
                                                                           {"cstype", freeform},
                                                                           {"deg", freeform},
                                                                           {"bmat", freeform},
                                                                           {"step", freeform},
                                                                           {"curv", freeform},
                                                                           {"curv2", freeform},
                                                                           {"surf", freeform},
                                                                           {"parm", freeform},
                                                                           {"trim", freeform},
                                                                           {"hole", freeform},
                                                                           {"scrv", freeform},
                                                                           {"sp", freeform},
                                                                           {"end", freeform},
                                                                           {"con", freeform},
                                                                           {"bsp", freeform},
                                                                           {"bzp", freeform},
                                                                           {"cdc", freeform},
                                                                           {"cdp", freeform},
                                                                           {"res", freeform}};
    const auto* const found =
        std::find_if(std::begin(keywords), std::end(keywords), [&](const auto& entry) { return entry.first == word; });
    return found == std::end(keywords) ? unknown : found->second;
}

}  // namespace octopair::io
