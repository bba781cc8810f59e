"""A camera calibrated by photographing a mapped site: resect each photograph, adjust all, say what is carried."""
