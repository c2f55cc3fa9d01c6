/* feature.c - records which features a scene file uses and how they are supported. A statement counts as
 * approximated if something was noted about it or the table says so, and as ignored if its handler says
 * so. */
#include "pbrt/state.h"

#include <stdio.h>
#include <string.h>

#define MAX_NAME 90 /* bytes of a feature's name */

static const struct kind {
    const char *directive, *name;
    bool by_directive;  /* the feature has the directive's name, else that of the class */
    const char *remark; /* how it is always approximated, or NULL */
} kinds[] = {
    { "Shape", "shape", false, NULL },
    { "LightSource", "light", false, NULL },
    { "AreaLightSource", "area light", false, NULL },
    { "Material", "material", false, NULL },
    { "MakeNamedMaterial", "material", false, NULL },
    { "Texture", "texture", false, NULL },
    { "ObjectInstance", "directive", true, NULL },
    { "MediumInterface", "medium", true, NULL },
    { "MakeNamedMedium", "medium", true, NULL },
    { "Volume", "medium", true, NULL },
    { "VolumeIntegrator", "medium", true, "light is scattered once, by points along each ray" },
    { "Film", "film", false, NULL },
    { "Camera", "camera", false, NULL },
    { "PixelFilter", "filter", false, NULL },
    { "Sampler", "sampler", false, "the number of samples counts; their places are our own" },
    { "Integrator", "integrator", false, "maxdepth counts; light is gathered by lightcuts" },
    { "SurfaceIntegrator", "integrator", false, "maxdepth counts; light is gathered by lightcuts" },
    { "Renderer", "directive", true, "light is gathered by lightcuts" },
    { "Option", "directive", true, "options of pbrt itself" },
    { "ColorSpace", "directive", true, NULL },
    { "Attribute", "directive", true, NULL },
    { "ActiveTransform", "directive", true, NULL },
    { "LightGroup", "directive", true, NULL },
    { "TransformTimes", "directive", true, NULL },
};

lc_status lc_pbrt_count_feature(lc_pbrt *p, const char *directive, uint64_t n_noted)
{
    char name[96];
    const char *text;
    size_t i = 0, n = sizeof kinds / sizeof *kinds;
    while (i < n && strcmp(kinds[i].directive, directive)) i++;
    if (i == n) return LC_OK;
    bool noted = lc_build_noted(p->scene, &text) > n_noted;
    lc_support support = p->ignored                 ? LC_SUPPORT_IGNORED
                         : noted || kinds[i].remark ? LC_SUPPORT_APPROXIMATED
                                                    : LC_SUPPORT_YES;
    const char *own = kinds[i].by_directive ? directive : p->owner;
    size_t len = 0;
    while (len < MAX_NAME && own[len] >= ' ' && own[len] < 127) len++;
    if (own[len]) { /* almost no name is so long or not ASCII */
        snprintf(name, sizeof name, "%.*s", MAX_NAME, own);
        lc_pbrt_printable(name);
        own = name;
    }
    return lc_build_feature(p->scene, kinds[i].name, own, support, noted ? text : kinds[i].remark);
}
