// The fixed parts of the report page.
#pragma once

namespace palpate {

extern const char* const report_style;     ///< CSS
extern const char* const report_body;      ///< HTML from the canvas to the plots
extern const char* const report_script;    ///< JavaScript: what is drawn, and ...
extern const char* const report_controls;  ///< ... what the user does

}  // namespace palpate
