// The fixed parts of the report page and of others that show a body: the files of
// formats/page, compiled in (cmake/EmbedText.cmake).
#pragma once

namespace palpate {

extern const char* const report_style;     ///< CSS
extern const char* const report_body;      ///< HTML from the canvas to the plots
extern const char* const figures_script;   ///< JavaScript: colours, numbers, plots
extern const char* const turnable_script;  ///< JavaScript: a body that can be turned
extern const char* const report_script;    ///< JavaScript: the report page's own

}  // namespace palpate
