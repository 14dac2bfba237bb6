def join_names(*parts):
    return "/".join(parts)
