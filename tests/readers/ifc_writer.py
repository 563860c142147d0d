"""Writes small IFC files, whose coordinates are stated in the open."""


class IfcWriter:
    """Lines of an IFC file. add() returns the reference of a line, for example '#12'."""

    def __init__(self, schema, unit_prefix=".MILLI."):
        self.schema, self.lines, self.ids = schema, [], 0
        self.owner = "$"
        if schema == "IFC2X3":
            person = self.add("IFCPERSON($,'P',$,$,$,$,$,$)")
            organisation = self.add("IFCORGANIZATION($,'O',$,$,$)")
            both = self.add(f"IFCPERSONANDORGANIZATION({person},{organisation},$)")
            program = self.add(f"IFCAPPLICATION({organisation},'1','test','test')")
            self.owner = self.add(f"IFCOWNERHISTORY({both},{program},$,.NOCHANGE.,$,$,$,0)")
        self.origin = self.place((0, 0, 0))
        context = self.add(f"IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,{self.origin},$)")
        self.body = self.add(f"IFCGEOMETRICREPRESENTATIONSUBCONTEXT('Body','Model',*,*,*,*,{context},$,.MODEL_VIEW.,$)")
        length = self.add(f"IFCSIUNIT(*,.LENGTHUNIT.,{unit_prefix},.METRE.)")
        units = self.add(f"IFCUNITASSIGNMENT(({length}))")
        self.project = self.add(f"IFCPROJECT({self.root('Project')},$,$,$,$,({context}),{units})")
        placed = self.local((0, 0, 0))
        self.building = self.add(f"IFCBUILDING({self.root('House')},$,{placed},$,$,.ELEMENT.,$,$,$)")
        self.storey = self.add(f"IFCBUILDINGSTOREY({self.root('Level 1')},$,{placed},$,$,.ELEMENT.,0.)")
        self.relate("IFCRELAGGREGATES", self.project, [self.building])
        self.relate("IFCRELAGGREGATES", self.building, [self.storey])

    def add(self, text):
        self.lines.append(text)
        return f"#{len(self.lines)}"

    def root(self, name, identifier=None):
        """Returns the first three attributes of an object: GlobalId, history, name."""
        self.ids += 1
        return f"'{identifier or self.global_id(self.ids)}',{self.owner},'{name}'"

    @staticmethod
    def global_id(number):
        return f"{number:022d}"

    def point(self, *coordinates):
        return self.add("IFCCARTESIANPOINT((" + ",".join(f"{float(c):.17g}" if "." in f"{float(c):.17g}" or "e" in f"{float(c):.17g}"
                                                         else f"{float(c):.17g}." for c in coordinates) + "))")

    def place(self, at):
        return self.add(f"IFCAXIS2PLACEMENT3D({self.point(*at)},$,$)")

    def local(self, at, parent="$"):
        return self.add(f"IFCLOCALPLACEMENT({parent},{self.place(at)})")

    def relate(self, kind, one, others):
        if kind == "IFCRELAGGREGATES":
            return self.add(f"{kind}({self.root('')},$,{one},({','.join(others)}))")
        return self.add(f"{kind}({self.root('')},$,({','.join(others)}),{one})")

    def block(self, low, high):
        """A solid box: a rectangle that is swept upward."""
        x, y, z = (b - a for a, b in zip(low, high))
        middle = self.add(f"IFCAXIS2PLACEMENT2D({self.point(low[0] + x / 2, low[1] + y / 2)},$)")
        outline = self.add(f"IFCRECTANGLEPROFILEDEF(.AREA.,$,{middle},{float(x)},{float(y)})")
        up = self.add("IFCDIRECTION((0.,0.,1.))")
        return self.add(f"IFCEXTRUDEDAREASOLID({outline},{self.place((0, 0, low[2]))},{up},{float(z)})")

    def brep(self, corners, faces):
        points = [self.point(*corner) for corner in corners]
        made = []
        for face in faces:
            loop = self.add(f"IFCPOLYLOOP(({','.join(points[i] for i in face)}))")
            made.append(self.add(f"IFCFACE(({self.add(f'IFCFACEOUTERBOUND({loop},.T.)')}))"))
        shell = self.add(f"IFCCLOSEDSHELL(({','.join(made)}))")
        return self.add(f"IFCFACETEDBREP({shell})")

    def difference(self, first, second):
        return self.add(f"IFCBOOLEANRESULT(.DIFFERENCE.,{first},{second})")

    def triangles(self, corners, triangles):
        """A tessellated face set, which IFC2x3 has not."""
        points = ",".join("(" + ",".join(str(float(c)) for c in corner) + ")" for corner in corners)
        listed = self.add(f"IFCCARTESIANPOINTLIST3D(({points}))")
        indices = ",".join("(" + ",".join(str(i + 1) for i in triangle) + ")" for triangle in triangles)
        return self.add(f"IFCTRIANGULATEDFACESET({listed},$,.T.,({indices}),$)")

    def represent(self, solids, kind="SweptSolid"):
        return self.add(f"IFCSHAPEREPRESENTATION({self.body},'Body','{kind}',({','.join(solids)}))")

    def mapped(self, solid):
        """Returns a function that places a shared solid: of its place to a representation."""
        source = self.add(f"IFCREPRESENTATIONMAP({self.origin},{self.represent([solid])})")

        def at(place):
            operator = self.add(f"IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,{self.point(*place)},1.,$)")
            return self.represent([self.add(f"IFCMAPPEDITEM({source},{operator})")], "MappedRepresentation")
        return at

    def element(self, kind, name, representation, rest, identifier=None, contained=True):
        shape = self.add(f"IFCPRODUCTDEFINITIONSHAPE($,$,({representation}))")
        added = self.add(f"{kind}({self.root(name, identifier)},$,$,{self.local((0, 0, 0))},{shape},{rest})")
        if contained:
            self.relate("IFCRELCONTAINEDINSPATIALSTRUCTURE", self.storey, [added])
        return added

    def text(self):
        head = ("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
                f"FILE_SCHEMA(('{self.schema}'));\nENDSEC;\nDATA;\n")
        return head + "".join(f"#{i + 1}={line};\n" for i, line in enumerate(self.lines)) + "ENDSEC;\nEND-ISO-10303-21;\n"
